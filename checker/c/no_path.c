#include <string.h>

#include "cells.h"
#include "pairs.h"
#include "proof.h"
#include "solids.h"

static const double LEAST = 1e-9;

/* A ball inside of a body. */
typedef struct {
  size_t body;
  Vector centre;
  double radius;
} Ball;

/* What a ball overlaps with: a shape of a body, or another ball. */
typedef struct {
  size_t body;
  const Solid* solid; /* or NULL */
  const Ball* ball;
} Target;

typedef struct {
  const Model* model;
  const Ball* balls;
  const Target* targets;
  Axes axes;
  Moved* moved;
  size_t* chain; /* room for the frames of one */
} Checker;

static bool is_obstacle(const Model* model, size_t body) { return body >= model->body_count; }

const char* name_of(const Model* model, size_t body) {
  if (!is_obstacle(model, body)) return model->bodies[body].name;
  return model->inputs->obstacles[body - model->body_count].name;
}

static size_t frame_of(const Model* model, size_t body) {
  return is_obstacle(model, body) ? 0 : model->bodies[body].frame;
}

/* The number of solids of a body, and one of them. */
static size_t solid_count(const Model* model, size_t body) {
  return is_obstacle(model, body) ? 1 : model->bodies[body].count;
}

static Solid* solid_at(const Model* model, size_t body, size_t i) {
  return is_obstacle(model, body) ? model->obstacles + (body - model->body_count) : model->bodies[body].solids[i];
}

/* Tell whether a witness may name a solid: a mesh, a cloud or a thin box has no distance here. */
static bool has_distance(const Solid* solid) {
  if (solid->shape->kind == MESH || solid->shape->kind == CLOUD) return false;
  for (int i = 0; solid->shape->kind == BOX && i < 3; ++i) {
    if (solid->shape->size[i] < 2 * LEAST) return false;
  }
  return true;
}

/* The distance of a point from a solid; less than 0 inside. */
static double distance(const Solid* solid, Vector point) {
  double o[3] = {0, 0, 0};
  const Vector *points = solid->points, *last = points + solid->point_count - 1;
  size_t count = solid->point_count == 8 ? 3 : 2;
  Vector from = difference(point, scaled(0.5, sum(points[0], *last)));
  if (count == 3) {
    for (int i = 0; i < 3; ++i) {
      Vector half = scaled(0.5, difference(points[1 << i], points[0]));
      o[i] = fabs(dot(from, half)) / length(half) - length(half);
    }
  } else {
    double along = dot(from, solid->axis);
    o[0] = length(difference(from, scaled(along, solid->axis))) - solid->disc;
    o[1] = fabs(along) - length(difference(*last, points[0])) / 2;
  }
  double outside = 0, inside = -INFINITY;
  for (size_t i = 0; i < count; ++i) {
    outside = hypot(outside, fmax(o[i], 0));
    inside = fmax(inside, o[i]);
  }
  return outside + fmin(inside, 0) - solid->ball;
}

/* The distance of a point from a segment. */
static double from_segment(Vector point, Vector a, Vector b) {
  Vector line = difference(b, a), from = difference(point, a);
  double size = dot(line, line), share = size > 0 ? fmin(1, fmax(0, dot(from, line) / size)) : 0;
  return length(difference(from, scaled(share, line)));
}

/* The distance of a point from a triangle: from its plane where the point is above it, else from its edges. */
static double from_triangle(Vector point, const Vector* c) {
  Vector normal = cross(difference(c[1], c[0]), difference(c[2], c[0]));
  double area = length(normal), nearest = INFINITY;
  bool above = area > 0;
  for (int i = 0; i < 3; ++i) {
    Vector a = c[i], b = c[(i + 1) % 3];
    above = above && dot(cross(difference(b, a), difference(point, a)), normal) >= 0;
    nearest = fmin(nearest, from_segment(point, a, b));
  }
  return above ? fmin(nearest, fabs(dot(difference(point, c[0]), normal)) / area) : nearest;
}

static bool is_inside_surface(const Solid* solid, const Ball* ball) {
  find_pieces(solid->shape->mesh);
  const Mesh* mesh = solid->shape->mesh;
  for (size_t i = 0; i < mesh->piece_count; ++i) {
    const Piece* piece = mesh->pieces + i;
    double nearest = piece->closed ? INFINITY : -INFINITY;
    for (size_t k = 0; k < piece->count && nearest >= ball->radius + LEAST; ++k) {
      Vector c[3];
      for (size_t n = 0; n < 3; ++n) c[n] = corner_at(solid, mesh->members[piece->begin + k], n);
      nearest = fmin(nearest, from_triangle(ball->centre, c));
    }
    if (nearest >= ball->radius + LEAST && is_inside(ball->centre, solid, piece)) return true;
  }
  return false;
}

static void require_inside_body(const Model* model, const Ball* ball) {
  for (size_t i = 0; i < solid_count(model, ball->body); ++i) {
    const Solid* solid = solid_at(model, ball->body, i);
    if (has_distance(solid) && distance(solid, ball->centre) <= -ball->radius - LEAST) return;
    if (is_surface(solid) && is_inside_surface(solid, ball)) return;
  }
  fail(REFUSED, "a ball is not inside of its body");
}

static Ball* read_balls(const Model* model) {
  const Certificate* certificate = model->certificate;
  Ball* balls = take(certificate->ball_count + 1, sizeof *balls);
  for (size_t i = 0; i < certificate->ball_count; ++i) {
    const uint8_t* data = certificate->balls + 18 * i;
    double numbers[4];
    for (int k = 0; k < 4; ++k) {
      numbers[k] = float_at(data + 2 + 4 * k);
      if (!(fabs(numbers[k]) <= FARTHEST)) fail(REFUSED, "a ball that is no number, or too large");
    }
    Ball ball = {(size_t)little_endian(data, 2), {numbers[0], numbers[1], numbers[2]}, numbers[3]};
    if (ball.body >= model->body_count + model->inputs->obstacle_count) fail(REFUSED, "a ball in no body");
    if (!(ball.radius >= 0)) fail(REFUSED, "a ball of a radius below 0");
    require_inside_body(model, &ball);
    balls[i] = ball;
  }
  return balls;
}

/* What witnesses name: every shape that is not made of triangles, in the order of bodies, then the balls. */
static Target* targets_of(const Model* model, const Ball* balls, size_t* count) {
  size_t bodies = model->body_count + model->inputs->obstacle_count, room = model->certificate->ball_count + 1;
  for (size_t body = 0; body < bodies; ++body) room += solid_count(model, body);
  Target* targets = take(room, sizeof *targets);
  for (size_t body = 0; body < bodies; ++body) {
    for (size_t i = 0; i < solid_count(model, body); ++i) {
      const Solid* solid = solid_at(model, body, i);
      if (!is_surface(solid)) targets[(*count)++] = (Target){body, solid, NULL};
    }
  }
  for (size_t i = 0; i < model->certificate->ball_count; ++i) {
    targets[(*count)++] = (Target){balls[i].body, NULL, balls + i};
  }
  return targets;
}

/* What two bodies keep from each other; fails unless the claim is about them. */
static double kept_by(const Model* model, size_t a, size_t b) {
  if (is_obstacle(model, a)) {
    size_t body = a;
    a = b;
    b = body;
  }
  bool of_claim = !is_obstacle(model, a) && frame_of(model, a) != frame_of(model, b);
  if (of_claim && is_obstacle(model, b)) {
    const Body* body = model->bodies + a;
    if (!body->allowed[b - model->body_count]) return model->certificate->clearance + body->padding;
  } else if (of_claim && !is_left_out(model, model->bodies + a, model->bodies + b)) {
    return 0;
  }
  fail(REFUSED, "a witness is about no pair of the claim");
}

/* Half the side of a cell, by which the joint of a frame moves; fails if its column is not the tree's. */
static double half_side(const Checker* checker, const Cell* cell, size_t frame) {
  const Axes* axes = &checker->axes;
  for (size_t i = 0; i < axes->count; ++i) {
    if (axes->columns[i] != checker->model->frames[frame].column) continue;
    double unit = (axes->range[i][1] - axes->range[i][0]) / UNITS;
    return fabs(checker->model->frames[frame].multiplier) * (cell->high[i] - cell->low[i]) * unit / 2;
  }
  fail(REFUSED, "a joint moves a witness and is not of its cells");
}

/* How far the centre of a ball moves in all, if it already moves by `moves` and a frame's joint moves as well. */
static double moved_by(const Checker* checker, const Cell* cell, size_t frame, Vector centre, double moves) {
  double by = half_side(checker, cell, frame);
  const Moved* at = checker->moved + frame;
  if (checker->model->frames[frame].slides) return moves + by;
  return moves + by * (length(cross(at->axis, difference(centre, at->pose.at))) + moves);
}

/* By how much a witness overlaps in every state of a cell, in whose middle the frames are. */
static double overlap(const Checker* checker, const Cell* cell, const Ball* ball, const Target* target) {
  const Model* model = checker->model;
  size_t a = frame_of(model, ball->body), b = frame_of(model, target->body), from = shared(model, a, b), count = 0;
  double kept = kept_by(model, ball->body, target->body), moves = 0;
  Vector centre = placed(&checker->moved[a].pose, ball->centre);
  for (size_t k = a; k != from; k = model->frames[k].parent) moves = moved_by(checker, cell, k, centre, moves);
  for (size_t k = b; k != from; k = model->frames[k].parent) checker->chain[count++] = k;
  while (count) moves = moved_by(checker, cell, checker->chain[--count], centre, moves);
  const Pose* pose = &checker->moved[b].pose;
  Vector seen = turned_in(pose, difference(centre, pose->at));
  double apart = target->solid ? distance(target->solid, seen)
                               : length(difference(seen, target->ball->centre)) - target->ball->radius;
  return ball->radius + kept - apart - moves;
}

static void place_middle(const Checker* checker, const Cell* cell) {
  const Model* model = checker->model;
  const Axes* axes = &checker->axes;
  for (size_t i = 1; i < model->frame_count; ++i) {
    double value = model->certificate->values[model->frames[i].column];
    for (size_t k = 0; k < axes->count; ++k) {
      double unit = (axes->range[k][1] - axes->range[k][0]) / UNITS;
      double middle = axes->range[k][0] + ((double)cell->low[k] + cell->high[k]) / 2 * unit;
      if (axes->columns[k] == model->frames[i].column) value = middle;
    }
    place_frame(model, i, value, checker->moved);
  }
}

static Axes axes_of(const Model* model, const Tree* tree) {
  Axes axes = {.count = tree->column_count};
  if (!axes.count || axes.count > MOST_COLUMNS) fail(REFUSED, "cells of no columns, or of too many");
  for (size_t i = 0; i < axes.count; ++i) {
    size_t column = axes.columns[i] = tree->columns[i];
    if (column >= model->certificate->joint_count) fail(REFUSED, "cells of a column that there is not");
    for (size_t k = 0; k < i; ++k) {
      if (axes.columns[k] == column) fail(REFUSED, "cells with a column twice");
    }
    axes.endless[i] = !range_of(model->inputs, model->certificate, column, axes.range[i]);
    if (axes.endless[i]) axes.range[i][0] = -(axes.range[i][1] = PI);
    if (!(axes.range[i][0] < axes.range[i][1])) fail(REFUSED, "a range of nothing");
    for (size_t k = 1; k < model->frame_count; ++k) {
      const Frame* frame = model->frames + k;
      bool turns = !frame->slides && frame->multiplier == rint(frame->multiplier);
      if (frame->column == column && axes.endless[i] && !turns) fail(REFUSED, "an endless joint does not come back");
    }
  }
  return axes;
}

/* Walk through a tree: gather its open cells, and check what blocks the others. */
static Cell* open_cells(Checker* checker, const Tree* tree, size_t target_count, NoPath* to, size_t* open_count) {
  const Certificate* certificate = checker->model->certificate;
  size_t waiting = 1, columns = checker->axes.count, bytes = bytes_of_answer(certificate, tree);
  size_t bodies = checker->model->body_count + checker->model->inputs->obstacle_count;
  Cell *cells = take(tree->answer_count + 2, sizeof *cells), *open = take(tree->answer_count + 1, sizeof *open);
  for (size_t i = 0; i < columns; ++i) cells[0].high[i] = UNITS;
  for (size_t i = 0; i < waiting; ++i) {
    const Cell* cell = cells + i;
    if (i == tree->answer_count) fail(REFUSED, "a cell without an answer");
    size_t answer = (size_t)little_endian(tree->answers + bytes * i, (int)bytes);
    if (!answer) {
      open[(*open_count)++] = *cell;
    } else if (answer <= columns) {
      uint32_t low = cell->low[answer - 1], high = cell->high[answer - 1];
      if (high - low < 2) fail(REFUSED, "a cell is halved too often");
      if (waiting + 2 > tree->answer_count) fail(REFUSED, "a cell without an answer");
      cells[waiting] = cells[waiting + 1] = *cell;
      cells[waiting].high[answer - 1] = cells[waiting + 1].low[answer - 1] = low + (high - low) / 2;
      waiting += 2;
    } else {
      size_t witness = answer - columns - 1;
      if (witness >= certificate->witness_count) fail(REFUSED, "there is no witness %zu", witness);
      size_t ball = (size_t)little_endian(certificate->witnesses + 4 * witness, 2);
      size_t target = (size_t)little_endian(certificate->witnesses + 4 * witness + 2, 2);
      if (ball >= certificate->ball_count || target >= target_count) fail(REFUSED, "a witness of nothing");
      const Target* of = checker->targets + target;
      if (of->solid && !has_distance(of->solid)) fail(REFUSED, "a witness of a solid that has no distance");
      place_middle(checker, cell);
      double by = overlap(checker, cell, checker->balls + ball, of);
      if (!(by > LEAST)) fail(REFUSED, "a cell is not blocked (%.3g m)", by);
      to->smallest = fmin(to->smallest, by);
      to->used[checker->balls[ball].body * bodies + of->body] = true;
      ++to->blocked;
    }
  }
  if (waiting != tree->answer_count) fail(REFUSED, "answers without a cell");
  return open;
}

/* Tell whether a joint is of the columns of the cells. */
static bool is_known(const Checker* checker, size_t frame) {
  for (size_t i = 0; i < checker->axes.count; ++i) {
    if (checker->axes.columns[i] == checker->model->frames[frame].column) return true;
  }
  return false;
}

/* How far a joint slides at most; nothing bounds one without limits. */
static double most_slide(const Model* model, const Frame* frame) {
  double range[2];
  if (!frame->slides) return 0;
  if (!range_of(model->inputs, model->certificate, frame->column, range)) return INFINITY;
  return fmax(fabs(frame->multiplier * range[0] + frame->offset), fabs(frame->multiplier * range[1] + frame->offset));
}

/* Tell whether no posture reaches a goal from a cell, in whose middle the frames are: the first joint on the way to the
   link that is of no column is too far away for all that follow, or too near. */
static bool is_beyond(const Checker* checker, const Cell* cell, const PoseGoal* goal) {
  const Frame* frames = checker->model->frames;
  const Place* place = place_of_link(checker->model, goal->link);
  size_t first = NONE, last = place->frame;
  for (size_t k = last; k; k = frames[k].parent) {
    if (!is_known(checker, k)) first = k;
  }
  Vector arm = place->pose.at, target = goal->pose.at, point = goal->turned ? (Vector){0, 0, 0} : arm;
  double near = goal->near, most = 0, longest = 0, moves = 0;
  if (goal->turned) {
    near += goal->tilt * length(arm);
    target = difference(target, turned(&goal->pose, turned_in(&place->pose, arm)));
  }
  if (first != NONE) {
    longest = goal->turned ? 0 : length(arm);
    most = longest + most_slide(checker->model, frames + first);
    for (size_t k = last; k != first; k = frames[k].parent) {
      double bar = length(frames[k].fixed.at);
      longest = fmax(longest, bar);
      most += bar + most_slide(checker->model, frames + k);
    }
    last = frames[first].parent;
    point = frames[first].fixed.at;
  }
  point = placed(&checker->moved[last].pose, point);
  for (size_t k = last; k; k = frames[k].parent) moves = moved_by(checker, cell, k, point, moves);
  double away = length(difference(point, target)), least = fmax(0, 2 * longest - most);
  return away - moves > most + near + LEAST || away + moves < least - near - LEAST;
}

/* Mark the goals, configurations before poses, that the start does not reach in the open cells of a tree. */
static void shut_off(Checker* checker, const Cell* open, size_t count, bool* shown) {
  const Certificate* certificate = checker->model->certificate;
  size_t goals = certificate->goals, all = goals + certificate->pose_count;
  const bool* reached = reached_from(certificate->values, &checker->axes, open, count);
  bool* meets = take(all, sizeof *meets);
  for (size_t i = 0; i < count; ++i) {
    if (!reached[i]) continue;
    if (all > goals) place_middle(checker, open + i);
    for (size_t goal = 0; goal < all; ++goal) {
      const double* point = certificate->values + (goal + 1) * certificate->joint_count;
      bool is_pose = goal >= goals;
      meets[goal] = meets[goal] || (is_pose ? !is_beyond(checker, open + i, certificate->poses + (goal - goals))
                                            : holds(&checker->axes, open + i, point));
    }
  }
  for (size_t goal = 0; goal < all; ++goal) shown[goal] = shown[goal] || !meets[goal];
}

NoPath verify_no_path(const Inputs* inputs, const Certificate* certificate) {
  if (memcmp(certificate->digest, inputs->digest, sizeof inputs->digest) != 0) {
    fail(REFUSED, "robot, SRDF, scene or meshes are not the files that it was written for");
  }
  Model* model = model_of(inputs, certificate);
  size_t bodies = model->body_count + inputs->obstacle_count, target_count = 0;
  Checker checker = {.model = model, .balls = read_balls(model)};
  checker.targets = targets_of(model, checker.balls, &target_count);
  checker.moved = take(model->frame_count, sizeof *checker.moved);
  checker.chain = take(model->frame_count, sizeof *checker.chain);
  checker.moved[0].pose = identity();
  NoPath found = {.model = model, .smallest = INFINITY, .used = take(bodies * bodies + 1, sizeof(bool))};
  found.columns = take(certificate->joint_count, sizeof(bool));
  size_t goals = certificate->goals + certificate->pose_count;
  bool* shown = take(goals, sizeof *shown);
  for (size_t i = 0; i < certificate->tree_count; ++i) {
    size_t open_count = 0;
    checker.axes = axes_of(model, certificate->trees + i);
    for (size_t k = 0; k < checker.axes.count; ++k) found.columns[checker.axes.columns[k]] = true;
    const Cell* open = open_cells(&checker, certificate->trees + i, target_count, &found, &open_count);
    shut_off(&checker, open, open_count, shown);
  }
  for (size_t i = 0; i < goals; ++i) {
    if (!shown[i]) fail(REFUSED, "a way to goal %zu is open", i);
  }
  return found;
}
