#include <string.h>

#include "cells.h"
#include "proof.h"

typedef struct {
  const Model* model;
  const Witness* witnesses;
  Axes axes;
  Moved* moved;
  size_t* chain; /* room for the frames of one */
} Checker;

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

/* How half the side of a cell along each column moves the centre of a ball to the first order, how far all do, and how
   far it strays from there. */
typedef struct {
  Vector ways[MOST_COLUMNS];
  double far, strays;
} Swept;

/* Add the joint of a frame, which moves the ball or, with a sign of -1, the solid. */
static void sweep(const Checker* checker, const Cell* cell, size_t frame, double sign, Vector centre, Swept* swept) {
  const Frame* joint = checker->model->frames + frame;
  const Moved* at = checker->moved + frame;
  double by = half_side(checker, cell, frame);
  Vector way = joint->slides ? at->axis : cross(at->axis, difference(centre, at->pose.at));
  size_t i = 0;
  while (checker->axes.columns[i] != joint->column) ++i;
  if (!joint->slides) swept->strays += by * (by * length(way) / 2 + swept->far);
  swept->far += by * length(way);
  swept->ways[i] = sum(swept->ways[i], scaled(joint->multiplier > 0 ? sign * by : -sign * by, way));
}

/* By how much a witness overlaps in every state of a cell, in whose middle the frames are; refuses what is too little.
   The distance is convex: it is largest where all columns are at an end. */
static double overlap(const Checker* checker, const Cell* cell, const Witness* witness) {
  const Model* model = checker->model;
  const Ball *ball = witness->ball, *other = witness->other;
  size_t a = model->bodies[ball->body].frame, b = model->bodies[witness->body].frame, count = 0;
  size_t from = shared(model, a, b);
  Vector centre = placed(&checker->moved[a].pose, ball->centre);
  Swept swept = {.far = 0};
  for (size_t k = a; k != from; k = model->frames[k].parent) sweep(checker, cell, k, 1, centre, &swept);
  for (size_t k = b; k != from; k = model->frames[k].parent) checker->chain[count++] = k;
  while (count) sweep(checker, cell, checker->chain[--count], -1, centre, &swept);
  const Pose* pose = &checker->moved[b].pose;
  double least = INFINITY;
  for (size_t back = 0; back < (size_t)1 << checker->axes.count; ++back) {
    Vector at = centre;
    for (size_t i = 0; i < checker->axes.count; ++i) at = sum(at, scaled(back >> i & 1 ? -1 : 1, swept.ways[i]));
    Vector seen = turned_in(pose, difference(at, pose->at));
    double apart =
        other ? length(difference(seen, other->centre)) - other->radius : distance_from(witness->solid, seen);
    double by = ball->radius + witness->kept - apart - swept.strays;
    if (!(by > SPARE)) fail(REFUSED, "a cell is not blocked (%.3g m)", by);
    least = fmin(least, by);
  }
  return least;
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
    axes.endless[i] = isinf(model->ranges[column][0]);
    axes.range[i][0] = axes.endless[i] ? -PI : model->ranges[column][0];
    axes.range[i][1] = axes.endless[i] ? PI : model->ranges[column][1];
    require_range(model, column);
  }
  return axes;
}

/* Walk through a tree: gather its open cells, and check what blocks the others. */
static Cell* open_cells(Checker* checker, const Tree* tree, NoPath* to, size_t* open_count) {
  const Certificate* certificate = checker->model->certificate;
  size_t waiting = 1, columns = checker->axes.count, bytes = bytes_of_answer(certificate, tree);
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
      place_middle(checker, cell);
      to->smallest = fmin(to->smallest, overlap(checker, cell, checker->witnesses + witness));
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
  const double* range = model->ranges[frame->column];
  if (!frame->slides) return 0;
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
  return away - moves > most + near + SPARE || away + moves < least - near - SPARE;
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
  Checker checker = {.model = model, .witnesses = read_witnesses(model)};
  checker.moved = take(model->frame_count, sizeof *checker.moved);
  checker.chain = take(model->frame_count, sizeof *checker.chain);
  checker.moved[0].pose = identity();
  NoPath found = {.model = model, .witnesses = checker.witnesses, .smallest = INFINITY};
  found.columns = take(certificate->joint_count, sizeof(bool));
  size_t goals = certificate->goals + certificate->pose_count;
  bool* shown = take(goals, sizeof *shown);
  for (size_t i = 0; i < certificate->tree_count; ++i) {
    size_t open_count = 0;
    checker.axes = axes_of(model, certificate->trees + i);
    for (size_t k = 0; k < checker.axes.count; ++k) found.columns[checker.axes.columns[k]] = true;
    const Cell* open = open_cells(&checker, certificate->trees + i, &found, &open_count);
    shut_off(&checker, open, open_count, shown);
  }
  for (size_t i = 0; i < goals; ++i) {
    if (!shown[i]) fail(REFUSED, "a way to goal %zu is open", i);
  }
  return found;
}
