#include <stdlib.h>
#include <string.h>

#include "pairs.h"

enum { LONGEST_MIMICRY = 10 };

static const double LIMIT_TOLERANCE = 1e-5, NO_RANGE = 1000, ROUNDING = 1e-9;

static double held_value(const Certificate* certificate, const char* name) {
  for (size_t i = 0; i < certificate->held_count; ++i) {
    if (!strcmp(certificate->held[i].name, name)) return certificate->held[i].value;
  }
  return 0;
}

/* A joint as `multiplier * value + offset` of a column, or as its constant offset if none moves it. */
static Frame value_of(const Inputs* inputs, const Certificate* certificate, const Joint* joint) {
  Frame frame = {.joint = joint, .multiplier = 1, .axis = joint->axis, .slides = joint->kind == SLIDES};
  for (int i = 0; joint->follows != NONE; ++i) {
    if (i == LONGEST_MIMICRY) fail(BAD_INPUT, "joint %s mimics too many joints", joint->name);
    frame.offset += frame.multiplier * joint->offset;
    frame.multiplier *= joint->multiplier;
    joint = inputs->joints + joint->follows;
  }
  frame.column = joint->kind == FIXED ? NONE : column_of(certificate, joint->name);
  if (frame.column == NONE) frame.offset += frame.multiplier * held_value(certificate, joint->name);
  return frame;
}

static double largest_value(const Model* model, const Frame* frame) {
  double largest = 0;
  for (size_t i = 0; i < model->extreme_count; ++i) {
    double value = model->extremes[i * model->certificate->joint_count + frame->column];
    largest = fmax(largest, fabs(frame->multiplier * value + frame->offset));
  }
  return largest + fabs(frame->multiplier) * model->certificate->tolerance;
}

static Pose step_of(const Frame* frame, double value) {
  Pose step = frame->slides ? identity() : pose_of_turn(frame->axis, value);
  if (frame->slides) step.at = scaled(value, frame->axis);
  return step;
}

/* Add a body unless it has no shapes; `of` is a link, or an attached object. */
static void add_body(Model* model, const Link* of, const Place* place, size_t attached) {
  if (!of->count) return;
  Body body = {.name = of->name, .frame = place->frame, .link = place->link, .attached = attached, .count = of->count};
  Solid* solids = take(of->count, sizeof *solids);
  body.solids = take(of->count, sizeof *body.solids);
  for (size_t i = 0; i < of->count; ++i) {
    Pose pose = composed(&place->pose, &of->shapes[i].pose);
    solids[i] = solid_of(of->shapes + i, &pose);
    body.solids[i] = solids + i;
  }
  body.node = node_of(body.solids, body.count, body.frame);
  model->bodies[model->body_count++] = body;
}

/* Begin a frame behind a joint that moves, or go on in the parent's; return where the child is. */
static Place behind(Model* model, const Place* place, const Joint* joint) {
  Pose fixed = composed(&place->pose, &joint->pose);
  Frame frame = value_of(model->inputs, model->certificate, joint);
  if (joint->kind == FIXED) return (Place){joint->child, place->frame, fixed};
  if (frame.column == NONE) {
    Pose step = step_of(&frame, frame.offset);
    return (Place){joint->child, place->frame, composed(&fixed, &step)};
  }
  frame.parent = place->frame;
  frame.fixed = fixed;
  model->frames[model->frame_count] = frame;
  return (Place){joint->child, model->frame_count++, identity()};
}

/* Walk through the links depth first, children in the order of their joints. */
static void walk(Model* model) {
  const Inputs* inputs = model->inputs;
  Place* stack = take(inputs->link_count + 1, sizeof *stack);
  Place* of_link = take(inputs->link_count + 1, sizeof *of_link);
  size_t waiting = 0, done = 0;
  model->order = take(inputs->link_count + 1, sizeof *model->order);
  model->of_link = of_link;
  stack[waiting++] = (Place){inputs->root, 0, identity()};
  model->frame_count = 1;
  while (waiting) {
    Place place = stack[--waiting];
    /* A joint waits as its child's link until its turn comes: frames are numbered on the way down. */
    size_t above = inputs->links[place.link].parent_joint;
    if (above != NONE) place = behind(model, of_link + inputs->joints[above].parent, inputs->joints + above);
    of_link[place.link] = place;
    model->order[done++] = place.link;
    add_body(model, inputs->links + place.link, &place, NONE);
    for (size_t i = inputs->joint_count; i--;) {
      if (inputs->joints[i].parent == place.link) stack[waiting++] = (Place){.link = inputs->joints[i].child};
    }
  }
  for (size_t i = 0; i < inputs->attached_count; ++i) {
    add_body(model, inputs->attached + i, of_link + inputs->attached[i].link, i);
  }
}

const Place* place_of_link(const Model* model, const char* link) {
  size_t number = link_named(model->inputs, link);
  if (number == NONE) fail(REFUSED, "the robot has no link %.60s", link);
  return model->of_link + number;
}

static void refuse_unknown_names(const Inputs* inputs, const Certificate* certificate) {
  for (size_t i = 0; i < certificate->joint_count; ++i) {
    size_t joint = joint_named(inputs, certificate->joints[i]);
    if (joint == NONE || inputs->joints[joint].kind == FIXED || inputs->joints[joint].follows != NONE) {
      fail(REFUSED, "no joint that moves by itself: %.60s", certificate->joints[i]);
    }
  }
  for (size_t i = 0; i < certificate->held_count; ++i) {
    const char* name = certificate->held[i].name;
    size_t joint = joint_named(inputs, name);
    bool stands = joint != NONE && inputs->joints[joint].kind != FIXED && inputs->joints[joint].follows == NONE;
    if (!stands || column_of(certificate, name) != NONE) fail(REFUSED, "no joint that can be held: %.60s", name);
  }
}

/* Narrow a range to that of a joint that follows another one, unless this leaves nothing of it. */
static void follow(const Frame* frame, double range[2]) {
  const Joint* joint = frame->joint;
  if (!joint->limited || joint->upper - joint->lower > NO_RANGE || frame->multiplier == 0) return;
  double a = (joint->lower - frame->offset) / frame->multiplier, b = (joint->upper - frame->offset) / frame->multiplier;
  double low = fmax(range[0], fmin(a, b)), high = fmin(range[1], fmax(a, b));
  if (!(high - low > ROUNDING)) return;
  range[0] = low;
  range[1] = high;
}

/* Find how far each joint may go, by its limits, by those of joints that follow it, and by those of the scene; and how
   many frames' joints a column moves at most. */
static void find_ranges(Model* model) {
  const Inputs* inputs = model->inputs;
  const Certificate* certificate = model->certificate;
  model->ranges = take(certificate->joint_count, sizeof *model->ranges);
  for (size_t column = 0; column < certificate->joint_count; ++column) {
    const Joint* joint = inputs->joints + joint_named(inputs, certificate->joints[column]);
    double *range = model->ranges[column], scene[2] = {0, 2 * NO_RANGE};
    bool limited = joint->limited && joint->upper - joint->lower <= NO_RANGE;
    range[0] = limited ? joint->lower : -INFINITY;
    range[1] = limited ? joint->upper : INFINITY;
    size_t moved = 0;
    for (size_t i = 1; i < model->frame_count; ++i) {
      if (model->frames[i].column != column) continue;
      if (model->frames[i].joint != joint) follow(model->frames + i, range);
      if (++moved > model->most_moved) model->most_moved = moved;
    }
    range[0] -= LIMIT_TOLERANCE;
    range[1] += LIMIT_TOLERANCE;
    numbers_of(inputs->limits, certificate->joints[column], scene, 2, "limits");
    if (scene[1] - scene[0] > NO_RANGE) continue;
    range[0] = fmax(range[0], scene[0] - LIMIT_TOLERANCE);
    range[1] = fmin(range[1], scene[1] + LIMIT_TOLERANCE);
  }
}

void require_range(const Model* model, size_t column) {
  const double* range = model->ranges[column];
  if (!(range[0] < range[1])) fail(REFUSED, "a range of nothing");
  for (size_t k = 1; k < model->frame_count; ++k) {
    const Frame* frame = model->frames + k;
    bool turns = !frame->slides && frame->multiplier == rint(frame->multiplier);
    if (frame->column == column && isinf(range[0]) && !turns) fail(REFUSED, "an endless joint does not come back");
  }
}

static void require_limits(const Model* model) {
  const Certificate* certificate = model->certificate;
  for (size_t i = 0; i < certificate->points * certificate->joint_count; ++i) {
    const double* range = model->ranges[i % certificate->joint_count];
    if (range[0] <= certificate->values[i] && certificate->values[i] <= range[1]) continue;
    fail(REFUSED, "%.60s leaves its limits", certificate->joints[i % certificate->joint_count]);
  }
}

/* Find the largest values of the joints, which are those of the points or, if they may be anywhere, the ends of their
   ranges; and how far frames are from those before them at most. */
static void find_lengths(Model* model) {
  const Certificate* certificate = model->certificate;
  size_t joints = certificate->joint_count;
  model->extremes = certificate->values;
  model->extreme_count = certificate->points;
  if (certificate->of_no_path || certificate->of_pairs) {
    double* ends = take(2 * joints, sizeof *ends);
    for (size_t i = 0; i < 2 * joints; ++i) {
      double end = model->ranges[i % joints][i / joints];
      ends[i] = isfinite(end) ? end : i < joints ? -PI : PI;
    }
    model->extremes = ends;
    model->extreme_count = 2;
  }
  for (size_t i = 1; i < model->frame_count; ++i) {
    Frame* frame = model->frames + i;
    frame->length = length(frame->fixed.at) + (frame->slides ? largest_value(model, frame) : 0);
  }
}

/* The largest number of joints from the root to a link. */
static size_t deepest(const Inputs* inputs) {
  size_t most = 0;
  for (size_t i = 0; i < inputs->link_count; ++i) {
    size_t depth = 0;
    for (size_t link = i; inputs->links[link].parent_joint != NONE; ++depth) {
      link = inputs->joints[inputs->links[link].parent_joint].parent;
    }
    if (depth > most) most = depth;
  }
  return most;
}

/* Refuse robots so long, or values so large, that rounding could exceed the least gap, or that pass a plane's box. */
static void require_bounded(const Model* model) {
  const Certificate* certificate = model->certificate;
  double largest = 0, factor = 1, robot = 0, farthest = 0, planes = 0;
  double* chain = take(model->frame_count, sizeof *chain);
  for (size_t i = 0; i < model->extreme_count * certificate->joint_count; ++i) {
    largest = fmax(largest, fabs(model->extremes[i]));
  }
  for (size_t i = 1; i < model->frame_count; ++i) {
    chain[i] = chain[model->frames[i].parent] + model->frames[i].length;
    factor = fmax(factor, fabs(model->frames[i].multiplier));
  }
  for (size_t i = 0; i < model->body_count; ++i) {
    const Node* node = model->bodies[i].node;
    double reach = chain[node->frame] + node->reach;
    if (node->frame) robot = fmax(robot, reach);
    farthest = fmax(farthest, reach);
  }
  for (size_t i = model->body_count; i < model->all_count; ++i) {
    farthest = fmax(farthest, reach_of(model->bodies[i].solids[0]));
  }
  for (size_t i = 0; i < certificate->kept_count; ++i) {
    const Place* place = place_of_link(model, certificate->kept[i].link);
    Vector point = placed(&place->pose, certificate->kept[i].part);
    if (!certificate->kept[i].is_axis) farthest = fmax(farthest, chain[place->frame] + length(point));
  }
  for (size_t i = 0; i < model->inputs->obstacle_count; ++i) {
    const Shape* shape = &model->inputs->obstacles[i].shape;
    if (shape->kind != PLANE) continue;
    planes = fmax(planes, fabs(dot(shape->pose.z, shape->pose.at)));
    if (robot + planes >= GROUND) fail(REFUSED, "the robot reaches beyond a plane");
  }
  double error = ldexp((double)deepest(model->inputs) * farthest * (1 + largest * factor), -46);
  if (!(error < ROUNDING)) fail(REFUSED, "too large a robot: sums may be wrong by %g m", error);
}

Model* model_of(const Inputs* inputs, const Certificate* certificate) {
  Model* model = take(1, sizeof *model);
  model->inputs = inputs;
  model->certificate = certificate;
  model->frames = take(inputs->joint_count + 1, sizeof *model->frames);
  model->bodies = take(inputs->link_count + inputs->attached_count + inputs->obstacle_count + 1, sizeof *model->bodies);
  refuse_unknown_names(inputs, certificate);
  walk(model);
  find_ranges(model);
  require_limits(model);
  find_lengths(model);
  find_allowed(model);
  find_pairs(model);
  require_bounded(model);
  return model;
}
