#include "proof.h"

enum { MOST_HALVINGS = 40 };
enum { HALVE_STRETCH, HALVE_FIRST, HALVE_SECOND, ALONG_CENTRES, ALONG_BY_BOXES, ALONG_BY_CORNERS };

static const double LEAST_GAP = 1e-9;

/* Two nodes of a pair during a stretch of a motion: part `index` of 2^level equal ones. */
typedef struct {
  size_t pair, motion;
  Node *first, *second;
  int level;
  uint64_t index;
} Task;

/* How one node moves as long as the other's frame stands still. */
typedef struct {
  Vector turn, slide; /* W and V of the page */
  double strays;      /* its bound of the acceleration */
} Motion;

void place_frame(const Model* model, size_t i, double value, Moved* moved) {
  const Frame* frame = model->frames + i;
  Pose before = composed(&moved[frame->parent].pose, &frame->fixed);
  value = frame->multiplier * value + frame->offset;
  moved[i].axis = turned(&before, frame->axis);
  if (frame->slides) {
    moved[i].pose = before;
    moved[i].pose.at = sum(before.at, scaled(value, moved[i].axis));
  } else {
    Pose turn = pose_of_turn(frame->axis, value);
    moved[i].pose = composed(&before, &turn);
  }
}

void place_frames(const Model* model, size_t motion, double middle, double half, Moved* moved) {
  const Certificate* certificate = model->certificate;
  size_t joints = certificate->joint_count;
  const double* points = certificate->values + motion * certificate->degree * joints;
  moved[0] = (Moved){.pose = identity()};
  for (size_t i = 1; i < model->frame_count; ++i) {
    const Frame* frame = model->frames + i;
    double p0 = points[frame->column], p2 = points[certificate->degree * joints + frame->column];
    double p1 = certificate->degree == 2 ? points[joints + frame->column] : 0.5 * (p0 + p2);
    double t = middle, value = (1 - t) * (1 - t) * p0 + 2 * t * (1 - t) * p1 + t * t * p2;
    Moved* to = moved + i;
    to->rate = frame->multiplier * 2 * ((1 - t) * (p1 - p0) + t * (p2 - p1));
    to->change = certificate->degree == 2 ? frame->multiplier * 2 * (p0 - 2 * p1 + p2) : 0;
    to->fastest = fabs(to->rate) + half * fabs(to->change);
    place_frame(model, i, value, moved);
  }
}

/* The last frame that both chains have. */
size_t shared(const Model* model, size_t a, size_t b) {
  while (a != b) {
    if (a > b) {
      a = model->frames[a].parent;
    } else {
      b = model->frames[b].parent;
    }
  }
  return a;
}

/* The motion of a node by the joints of its chain below the frame `from`. */
static Motion motion_of(const Model* model, const Moved* moved, const Node* node, size_t from) {
  Motion motion = {{0, 0, 0}, {0, 0, 0}, 0};
  double above = 0, lever = node->reach;
  for (size_t k = node->frame; k != from; k = model->frames[k].parent) {
    if (!model->frames[k].slides) above += moved[k].fastest;
  }
  for (size_t k = node->frame; k != from; k = model->frames[k].parent) {
    const Moved* at = moved + k;
    bool slides = model->frames[k].slides;
    double turns = slides ? 0 : at->fastest;
    above -= turns;
    if (slides) {
      motion.slide = sum(motion.slide, scaled(at->rate, at->axis));
    } else {
      motion.turn = sum(motion.turn, scaled(at->rate, at->axis));
      motion.slide = sum(motion.slide, scaled(at->rate, cross(at->pose.at, at->axis)));
    }
    motion.strays += (slides ? 1 : lever) * (at->fastest * (2 * above + turns) + fabs(at->change));
    lever += model->frames[k].length;
  }
  return motion;
}

/* The largest value along a normal that turns as the node moves, `time` from the middle of the stretch. */
static double farthest(const Node* node, const Moved* moved, const Motion* motion, Vector normal, double time,
                       bool by_box) {
  Vector seen = sum(normal, scaled(time, cross(normal, motion->turn)));
  const Pose* pose = &moved[node->frame].pose;
  double reach = support(node, turned_in(pose, seen), by_box);
  return reach + dot(seen, pose->at) + time * dot(normal, motion->slide);
}

/* By how much a direction separates the nodes of a task throughout its stretch. */
static double gap_along(const Model* model, const Moved* moved, const Task* task, double half, Vector normal,
                        bool by_box) {
  size_t from = shared(model, task->first->frame, task->second->frame);
  Motion first = motion_of(model, moved, task->first, from), second = motion_of(model, moved, task->second, from);
  Vector back = scaled(-1, normal);
  double least = INFINITY;
  for (int i = -1; i <= 1; i += 2) {
    double high = farthest(task->first, moved, &first, normal, i * half, by_box);
    double low = -farthest(task->second, moved, &second, back, i * half, by_box);
    least = fmin(least, low - high);
  }
  return least - half * half / 2 * (first.strays + second.strays) - model->pairs[task->pair].margin;
}

static Vector between_centres(const Moved* moved, const Task* task) {
  Vector a = placed(&moved[task->first->frame].pose, task->first->centre);
  Vector b = placed(&moved[task->second->frame].pose, task->second->centre);
  Vector line = difference(b, a);
  if (!(length(line) > 1e-6)) fail(REFUSED, "a line between two equal centres");
  return scaled(1 / length(line), line);
}

static Node* half_or_refuse(Node* node, bool second) {
  Node* half = half_of(node, second);
  if (!half) fail(REFUSED, "a node of one element is halved");
  return half;
}

/* The two halves of a task. */
static void halve(const Task* task, int answer, Task halves[2]) {
  halves[0] = halves[1] = *task;
  for (int i = 0; i < 2; ++i) {
    if (answer == HALVE_STRETCH) {
      if (task->level == MOST_HALVINGS) fail(REFUSED, "a stretch is halved more than %d times", MOST_HALVINGS);
      ++halves[i].level;
      halves[i].index = 2 * task->index + (uint64_t)i;
    } else if (answer == HALVE_FIRST) {
      halves[i].first = half_or_refuse(task->first, i);
    } else {
      halves[i].second = half_or_refuse(task->second, i);
    }
  }
}

double prove(Model* model) {
  const Certificate* certificate = model->certificate;
  size_t answers = certificate->answer_count, waiting = 0, next_direction = 0;
  if (model->pair_count > answers / certificate->motions) fail(REFUSED, "tasks without an answer");
  Task* tasks = take(answers, sizeof *tasks);
  Moved* moved = take(model->frame_count, sizeof *moved);
  double smallest = INFINITY;
  for (size_t motion = 0; motion < certificate->motions; ++motion) {
    for (size_t i = 0; i < model->pair_count; ++i) {
      tasks[waiting++] =
          (Task){.pair = i, .motion = motion, .first = model->pairs[i].first, .second = model->pairs[i].second};
    }
  }
  for (size_t i = 0; i < waiting; ++i) {
    const Task* task = tasks + i;
    int answer = answer_at(certificate, i);
    if (answer <= HALVE_SECOND) {
      if (answers - waiting < 2) fail(REFUSED, "tasks without an answer");
      halve(task, answer, tasks + waiting);
      waiting += 2;
      continue;
    }
    double half = ldexp(0.5, -task->level);
    place_frames(model, task->motion, ldexp((double)task->index + 0.5, -task->level), half, moved);
    bool given = answer != ALONG_CENTRES;
    if (given && next_direction == certificate->direction_count) fail(REFUSED, "a direction is missing");
    Vector normal = given ? direction_at(certificate, next_direction++) : between_centres(moved, task);
    double gap = gap_along(model, moved, task, half, normal, answer != ALONG_BY_CORNERS);
    if (!(gap > LEAST_GAP)) fail(REFUSED, "task %zu: a direction that does not separate (%.3g m)", i, gap);
    smallest = fmin(smallest, gap);
    Pair* pair = model->pairs + task->pair;
    if (task->first == pair->first && task->second == pair->second) pair->apart = true;
  }
  if (waiting != answers) fail(REFUSED, "answers without a task");
  if (next_direction != certificate->direction_count) fail(REFUSED, "directions without a task");
  return smallest;
}
