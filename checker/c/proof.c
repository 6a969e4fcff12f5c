#include "proof.h"

#include "never.h"

enum { MOST_HALVINGS = 40 };
enum { HALVE_STRETCH, HALVE_FIRST, HALVE_SECOND, ALONG_CENTRES, ALONG_BY_BOXES, ALONG_BY_CORNERS };

static const double LEAST_GAP = 1e-9;

/* Two nodes of a pair, or a constraint and no nodes, during part `index` of 2^level equal ones of a motion. */
typedef struct {
  size_t number, motion; /* of the pair or constraint */
  Node *first, *second;
  int level;
  uint64_t index;
} Task;

/* How one node moves as long as the other's frame stands still. */
typedef struct {
  Vector turn, slide; /* W and V of the page */
  double strays, off; /* bounds of the acceleration, and of the square of what the tolerance moves */
} Motion;

/* The tasks, which are as many as the answers, and how far they are answered. */
typedef struct {
  Model* model;
  Task* tasks;
  size_t done, waiting, directions;
  Moved* moved;
  Stretch stretch;
  double smallest;
} Proof;

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

void place_chain(const Model* model, size_t i, const Stretch* stretch, Moved* moved) {
  if (!i || moved[i].stretch == stretch->number) return;
  const Certificate* certificate = model->certificate;
  const Frame* frame = model->frames + i;
  place_chain(model, frame->parent, stretch, moved);
  size_t joints = certificate->joint_count, degree = certificate->degree;
  Moved* to = moved + i;
  to->stretch = stretch->number;
  if (stretch->cell) {
    to->rate = frame->multiplier * stretch->cell[frame->column][1];
    to->fastest = fabs(to->rate);
    place_frame(model, i, stretch->cell[frame->column][0], moved);
    return;
  }
  const double* points = certificate->values + stretch->motion * degree * joints + frame->column;
  double t = stretch->middle, p0 = points[0], p2 = points[degree * joints];
  double p1 = degree == 2 ? points[joints] : 0.5 * (p0 + p2);
  to->rate = frame->multiplier * 2 * ((1 - t) * (p1 - p0) + t * (p2 - p1));
  to->change = degree == 2 ? frame->multiplier * 2 * (p0 - 2 * p1 + p2) : 0;
  to->fastest = fabs(to->rate) + stretch->half * fabs(to->change);
  place_frame(model, i, (1 - t) * (1 - t) * p0 + 2 * t * (1 - t) * p1 + t * t * p2, moved);
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

/* The motion of what reaches so far about a frame, or of a vector there, by the joints of its chain below `from`. */
static Motion motion_of(const Model* model, const Moved* moved, size_t frame, size_t from, double reach, bool vector) {
  Motion motion = {{0, 0, 0}, {0, 0, 0}, 0, 0};
  double above = 0, lever = reach;
  for (size_t k = frame; k != from; k = model->frames[k].parent) {
    if (!model->frames[k].slides) above += moved[k].fastest;
  }
  for (size_t k = frame; k != from; k = model->frames[k].parent) {
    const Frame* joint = model->frames + k;
    const Moved* at = moved + k;
    double turns = joint->slides ? 0 : at->fastest, far = joint->slides ? !vector : vector ? 1 : lever;
    above -= turns;
    if (joint->slides) {
      motion.slide = sum(motion.slide, scaled(at->rate, at->axis));
    } else {
      motion.turn = sum(motion.turn, scaled(at->rate, at->axis));
      motion.slide = sum(motion.slide, scaled(at->rate, cross(at->pose.at, at->axis)));
    }
    motion.strays += far * (at->fastest * (2 * above + turns) + fabs(at->change));
    motion.off += pow(far * joint->multiplier * model->certificate->tolerance, 2) * (double)model->most_moved;
    lever += joint->length;
  }
  return motion;
}

/* The largest values of a node along a normal that turns as it moves, at both ends of a stretch. */
static void find_farthest(Node* node, const Moved* moved, const Motion* motion, Vector normal, double half, bool by_box,
                          double farthest[2]) {
  const Pose* pose = &moved[node->frame].pose;
  Vector seen[2], directions[2];
  for (int i = 0; i < 2; ++i) {
    seen[i] = sum(normal, scaled(i ? half : -half, cross(normal, motion->turn)));
    directions[i] = turned_in(pose, seen[i]);
  }
  find_supports(node, directions, by_box, farthest);
  for (int i = 0; i < 2; ++i) {
    farthest[i] += dot(seen[i], pose->at) + (i ? half : -half) * dot(normal, motion->slide);
  }
}

/* By how much a direction separates the nodes of a task throughout its stretch. */
static double gap_along(const Proof* proof, const Task* task, Vector normal, bool by_box) {
  const Model* model = proof->model;
  const Moved* moved = proof->moved;
  double half = proof->stretch.half;
  size_t from = shared(model, task->first->frame, task->second->frame);
  Motion first = motion_of(model, moved, task->first->frame, from, task->first->reach, false);
  Motion second = motion_of(model, moved, task->second->frame, from, task->second->reach, false);
  double high[2], low[2];
  find_farthest(task->first, moved, &first, normal, half, by_box, high);
  find_farthest(task->second, moved, &second, scaled(-1, normal), half, by_box, low);
  double lost = half * half / 2 * (first.strays + second.strays) + sqrt(first.off + second.off);
  return fmin(-low[0] - high[0], -low[1] - high[1]) - lost - model->pairs[task->number].margin;
}

static Vector between_centres(const Moved* moved, const Task* task) {
  Vector a = placed(&moved[task->first->frame].pose, task->first->centre);
  Vector b = placed(&moved[task->second->frame].pose, task->second->centre);
  Vector line = difference(b, a);
  if (!(length(line) > 1e-6)) fail(REFUSED, "a line between two equal centres");
  return scaled(1 / length(line), line);
}

/* How far a place is from the box of a constraint. */
static double distance(const Kept* kept, Vector at) {
  Vector seen = turned_in(&kept->box, at), below = difference(kept->low, seen), beyond = difference(seen, kept->high);
  Vector off = {fmax(fmax(below.x, beyond.x), 0), fmax(fmax(below.y, beyond.y), 0), fmax(fmax(below.z, beyond.z), 0)};
  return length(off);
}

/* By how much a constraint may be exceeded in a stretch. */
static double excess(const Proof* proof, const Kept* kept) {
  const Moved* moved = proof->moved;
  const Place* place = place_of_link(proof->model, kept->link);
  double half = proof->stretch.half;
  place_chain(proof->model, place->frame, &proof->stretch, proof->moved);
  const Pose* pose = &moved[place->frame].pose;
  Vector part = kept->is_axis ? turned(&place->pose, kept->part) : placed(&place->pose, kept->part);
  Vector at = kept->is_axis ? turned(pose, part) : placed(pose, part);
  Motion motion = motion_of(proof->model, moved, place->frame, 0, length(part), kept->is_axis);
  Vector moves = cross(motion.turn, at);
  if (!kept->is_axis) moves = sum(moves, motion.slide);
  double worst = 0;
  for (int i = -1; i <= 1; i += 2) worst = fmax(worst, distance(kept, sum(at, scaled(i * half, moves))));
  return worst + half * half / 2 * motion.strays + sqrt(motion.off) - kept->limit;
}

static Node* half_or_refuse(Node* node, bool second) {
  Node* half = node ? half_of(node, second) : NULL;
  if (!half) fail(REFUSED, "a node of one element is halved, or of a constraint");
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

/* Check a direction that separates the nodes of a task: in a cell along each diagonal. */
static void separate(Proof* proof, const Task* task, int answer) {
  const Certificate* certificate = proof->model->certificate;
  bool given = answer != ALONG_CENTRES;
  Pair* pair = proof->model->pairs + task->number;
  if (given && proof->directions == certificate->direction_count) fail(REFUSED, "a direction is missing");
  Vector normal = given ? direction_at(certificate, proof->directions++) : (Vector){0, 0, 0};
  for (size_t back = 0; !back || back < ((size_t)1 << pair->moving_count) >> 1; ++back) {
    if (pair->line) begin_cell(proof->model, pair, (size_t)task->level, task->index, back, &proof->stretch);
    place_chain(proof->model, task->first->frame, &proof->stretch, proof->moved);
    place_chain(proof->model, task->second->frame, &proof->stretch, proof->moved);
    if (!given) normal = between_centres(proof->moved, task);
    double gap = gap_along(proof, task, normal, answer != ALONG_BY_CORNERS);
    if (!(gap > LEAST_GAP)) fail(REFUSED, "task %zu: a direction that does not separate (%.3g m)", proof->done, gap);
    proof->smallest = fmin(proof->smallest, gap);
  }
  if (task->first == pair->first && task->second == pair->second) pair->apart = true;
}

/* Begin the stretch of a task, unless it is that of the one before. */
static void begin_stretch(Proof* proof, const Task* task) {
  Stretch* stretch = &proof->stretch;
  double middle = ldexp((double)task->index + 0.5, -task->level), half = ldexp(0.5, -task->level);
  if (stretch->motion == task->motion && stretch->middle == middle && stretch->half == half) return;
  *stretch = (Stretch){task->motion, stretch->number + 1, middle, half, NULL};
}

/* Answer all tasks that wait, and those that they make. */
static void answer_all(Proof* proof) {
  const Certificate* certificate = proof->model->certificate;
  for (; proof->done < proof->waiting; ++proof->done) {
    const Task* task = proof->tasks + proof->done;
    int answer = answer_at(certificate, proof->done);
    if (answer <= HALVE_SECOND) {
      if (certificate->answer_count - proof->waiting < 2) fail(REFUSED, "tasks without an answer");
      halve(task, answer, proof->tasks + proof->waiting);
      proof->waiting += 2;
      continue;
    }
    if (!certificate->of_pairs) begin_stretch(proof, task);
    if (task->first) {
      separate(proof, task, answer);
    } else {
      const Kept* kept = certificate->kept + task->number;
      if (answer != ALONG_CENTRES) fail(REFUSED, "an answer to a constraint is a direction");
      if (!(excess(proof, kept) <= LEAST_GAP)) {
        fail(REFUSED, "%.60s is not proved to keep its constraint", kept->link);
      }
    }
  }
}

/* Begin a queue: each pair, or each constraint, for each motion. */
static void begin(Proof* proof, size_t count, bool of_pairs) {
  const Certificate* certificate = proof->model->certificate;
  if (count > (certificate->answer_count - proof->waiting) / certificate->motions) {
    fail(REFUSED, "tasks without an answer");
  }
  for (size_t motion = 0; motion < certificate->motions; ++motion) {
    for (size_t i = 0; i < count; ++i) {
      Task task = {.number = i, .motion = motion};
      if (of_pairs) task.first = proof->model->pairs[i].first, task.second = proof->model->pairs[i].second;
      proof->tasks[proof->waiting++] = task;
    }
  }
}

double prove(Model* model) {
  const Certificate* certificate = model->certificate;
  Proof proof = {.model = model, .smallest = INFINITY};
  proof.tasks = take(certificate->answer_count + 1, sizeof *proof.tasks);
  proof.moved = take(model->frame_count, sizeof *proof.moved);
  proof.moved[0].pose = identity();
  if (certificate->of_pairs) proof.stretch.cell = lowest_cell(model);
  for (size_t i = 0; certificate->of_pairs && i < model->pair_count; ++i) {
    if (proof.waiting == certificate->answer_count) fail(REFUSED, "tasks without an answer");
    const Pair* pair = model->pairs + i;
    proof.tasks[proof.waiting++] = (Task){.number = i, .first = pair->first, .second = pair->second};
    answer_all(&proof);
  }
  if (!certificate->of_pairs) begin(&proof, model->pair_count, true);
  answer_all(&proof);
  if (certificate->kept_count) begin(&proof, certificate->kept_count, false);
  answer_all(&proof);
  if (proof.waiting != certificate->answer_count) fail(REFUSED, "answers without a task");
  if (proof.directions != certificate->direction_count) fail(REFUSED, "directions without a task");
  return proof.smallest;
}
