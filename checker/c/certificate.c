#include "certificate.h"

#include <stdlib.h>
#include <string.h>

static const char MAGIC[] = "evenroad certificate 1\n", OF_NO_PATH[] = "evenroad certificate of no path 1\n",
                  OF_PAIRS[] = "evenroad certificate of pairs 1\n";

/* Lines that may stand once: of all certificates, of paths, of no path, and those that may be left out. */
enum {
  INPUTS,
  DEGREE,
  MOTIONS,
  ANSWERS,
  DIRECTIONS,
  GOALS,
  BALLS,
  WITNESSES,
  CLEARANCE,
  TOLERANCE,
  ROBOT,
  SCENE,
  ONCE
};
enum { LONGEST_HEADER = 1 << 16, MOST_MOTIONS = 1 << 20 };

static size_t count_of(const char* text) {
  size_t width = strspn(text, "0123456789");
  if (!width || width > 9 || text[width]) fail(REFUSED, "no count: %.20s", text);
  return strtoul(text, NULL, 10);
}

static double number_of(const char* text) {
  double number = 0;
  if (text[strspn(text, "0123456789+-.eE")] || !are_numbers(text, &number, 1)) fail(REFUSED, "no number: %.40s", text);
  return number;
}

/* Cut a word off a text, which goes to what stands behind its blank. */
static char* next_word(char** text) {
  char *word = *text, *blank = strchr(word, ' ');
  if (!blank) fail(REFUSED, "a line that is too short: %.60s", word);
  *blank = 0;
  *text = blank + 1;
  return word;
}

static double length_of(const char* text) {
  double number = number_of(text);
  if (!(number >= 0 && number <= 1)) fail(REFUSED, "a length must be 0 to 1 m: %.20s", text);
  return number;
}

/* A value and a name behind it. */
static Named named(char* text) {
  double value = number_of(next_word(&text));
  return (Named){text, value};
}

static Vector vector_of(char** text) {
  double numbers[3];
  for (int i = 0; i < 3; ++i) numbers[i] = number_of(next_word(text));
  return (Vector){numbers[0], numbers[1], numbers[2]};
}

static Vector unit_of(char** text) {
  Vector vector = vector_of(text);
  if (!(length(vector) > 1e-6)) fail(REFUSED, "a vector without a length");
  return scaled(1 / length(vector), vector);
}

/* A quaternion, and the pose that is turned by it. */
static Pose pose_of(char** text, double xyzw[4], Vector at) {
  double square = 0;
  for (int i = 0; i < 4; ++i) xyzw[i] = number_of(next_word(text)), square += xyzw[i] * xyzw[i];
  if (!(square > 1e-18)) fail(REFUSED, "a quaternion of length 0");
  return pose_of_quaternion(xyzw, at);
}

static double positive(char** text) {
  double number = number_of(next_word(text));
  if (!(number >= 0)) fail(REFUSED, "a constraint, or a goal, within less than 0");
  return number;
}

/* Read a constraint, and put it behind all others of its kind. */
static void add_kept(Certificate* to, char* text, bool is_axis) {
  Kept kept = {.is_axis = is_axis, .within = positive(&text), .box = identity()};
  if (is_axis) {
    kept.part = unit_of(&text);
    kept.low = kept.high = unit_of(&text);
    kept.limit = 2 * sin(fmin(kept.within, PI) / 2);
  } else {
    kept.part = vector_of(&text);
    kept.box = pose_of(&text, kept.xyzw, (Vector){0, 0, 0});
    kept.low = vector_of(&text);
    kept.high = vector_of(&text);
    kept.limit = kept.within;
  }
  kept.link = text;
  size_t at = is_axis ? to->axis_count++ : to->kept_count;
  memmove(to->kept + at + 1, to->kept + at, (to->kept_count++ - at) * sizeof kept);
  to->kept[at] = kept;
}

static void add_pose(Certificate* to, char* text, bool turned) {
  PoseGoal goal = {.turned = turned, .near = positive(&text), .pose = identity()};
  if (turned) goal.tilt = positive(&text);
  goal.pose.at = vector_of(&text);
  if (turned) goal.pose = pose_of(&text, goal.xyzw, goal.pose.at);
  goal.link = text;
  to->poses[to->pose_count++] = goal;
}

static void add_limit(Certificate* to, char* text) {
  Limit limit = {.velocity = positive(&text)};
  limit.acceleration = positive(&text);
  limit.name = text;
  for (size_t i = 0; i < to->limit_count; ++i) {
    if (!strcmp(to->limits[i].name, text)) fail(REFUSED, "a limit comes twice: %.60s", text);
  }
  to->limits[to->limit_count++] = limit;
}

static void add_named(Named* list, size_t* count, Named one) {
  for (size_t i = 0; i < *count; ++i) {
    if (!strcmp(list[i].name, one.name)) fail(REFUSED, "named twice: %.60s", one.name);
  }
  list[(*count)++] = one;
}

/* The digest of a file of which others were made, or a dash. */
static const char* origin_of(const char* text) {
  bool digest = strlen(text) == 64 && strspn(text, "0123456789abcdef") == 64;
  if (!digest && strcmp(text, "-") != 0) fail(REFUSED, "no digest: %.80s", text);
  return text;
}

static void read_digest(Certificate* to, const char* text) {
  if (*origin_of(text) == '-') fail(REFUSED, "no digest");
  for (int i = 0; i < 32; ++i) {
    char two[3] = {text[2 * i], text[2 * i + 1], 0};
    to->digest[i] = (uint8_t)strtoul(two, NULL, 16);
  }
}

/* Columns or, before them, the count of answers. */
static Tree tree_of(char* text, bool counted) {
  Tree tree = {.columns = take(strlen(text) / 2 + 1, sizeof *tree.columns)};
  for (char* next = text; next; text = next) {
    next = strchr(text, ' ');
    if (next) *next++ = 0;
    size_t number = count_of(text);
    if (counted) {
      tree.answer_count = number;
    } else {
      tree.columns[tree.column_count++] = number;
    }
    counted = false;
  }
  return tree;
}

/* Read one line; those that may stand once only are counted in `seen`. */
static void read_line(Certificate* to, char* line, bool seen[ONCE]) {
  static const char* const once[ONCE] = {"inputs", "degree",    "motions",   "answers",   "directions", "goals",
                                         "balls",  "witnesses", "clearance", "tolerance", "robot",      "scene"};
  size_t* counts[ONCE] = {[DEGREE] = &to->degree,
                          [MOTIONS] = &to->motions,
                          [ANSWERS] = &to->answer_count,
                          [DIRECTIONS] = &to->direction_count,
                          [GOALS] = &to->goals,
                          [BALLS] = &to->ball_count,
                          [WITNESSES] = &to->witness_count};
  char* value = line;
  next_word(&value);
  for (int i = 0; i < ONCE; ++i) {
    if (strcmp(line, once[i]) != 0) continue;
    if (seen[i]) fail(REFUSED, "said twice: %s", line);
    seen[i] = true;
    if (counts[i]) *counts[i] = count_of(value);
    if (i == INPUTS) read_digest(to, value);
    if (i == CLEARANCE) to->clearance = length_of(value);
    if (i == TOLERANCE) to->tolerance = length_of(value);
    if (i == ROBOT) to->robot = origin_of(value);
    if (i == SCENE) to->scene = origin_of(value);
    return;
  }
  if (!strcmp(line, "joint")) {
    for (size_t i = 0; i < to->joint_count; ++i) {
      if (!strcmp(to->joints[i], value)) fail(REFUSED, "joint %.60s is named twice", value);
    }
    to->joints[to->joint_count++] = value;
  } else if (!to->of_no_path && !to->of_pairs && (!strcmp(line, "axis") || !strcmp(line, "point"))) {
    add_kept(to, value, *line == 'a');
  } else if (!to->of_no_path && !to->of_pairs && !strcmp(line, "limit")) {
    add_limit(to, value);
  } else if (to->of_no_path && (!strcmp(line, "position") || !strcmp(line, "pose"))) {
    add_pose(to, value, !strcmp(line, "pose"));
  } else if (!strcmp(line, "cells") && to->of_no_path) {
    to->trees[to->tree_count++] = tree_of(value, true);
  } else if (!strcmp(line, "pair") && to->of_pairs) {
    to->trees[to->tree_count++] = tree_of(value, false);
  } else if (!strcmp(line, "held")) {
    add_named(to->held, &to->held_count, named(value));
  } else if (!strcmp(line, "padding")) {
    Named one = named(value);
    if (!(one.value >= 0 && one.value <= 1)) fail(REFUSED, "padding must be 0 to 1 m: %g", one.value);
    add_named(to->padding, &to->padding_count, one);
  } else {
    fail(REFUSED, "a line that is not known: %.60s", line);
  }
}

size_t column_of(const Certificate* certificate, const char* name) {
  for (size_t i = 0; i < certificate->joint_count; ++i) {
    if (!strcmp(certificate->joints[i], name)) return i;
  }
  return NONE;
}

static void require_counts(const Certificate* certificate, const bool seen[ONCE]) {
  for (int i = 0; i <= WITNESSES; ++i) {
    bool of_path = i < ANSWERS && !certificate->of_pairs;
    bool needed =
        i == INPUTS || (i >= GOALS ? certificate->of_no_path : !certificate->of_no_path && (of_path || i >= ANSWERS));
    if (seen[i] != needed) fail(REFUSED, "a line is missing, or is of another kind of certificate");
  }
  if (!certificate->joint_count) fail(REFUSED, "no joint is named");
  for (size_t i = 0; i < certificate->limit_count; ++i) {
    if (column_of(certificate, certificate->limits[i].name) == NONE) fail(REFUSED, "a limit is of no joint");
  }
  if (seen[TOLERANCE] && (certificate->of_no_path || certificate->of_pairs)) fail(REFUSED, "a tolerance of no path");
  if (certificate->of_pairs) {
    if (certificate->clearance > 0 || certificate->padding_count) fail(REFUSED, "a distance between links");
    if (!certificate->tree_count) fail(REFUSED, "no pair");
  } else if (certificate->of_no_path) {
    if (!(certificate->goals + certificate->pose_count) || !certificate->tree_count)
      fail(REFUSED, "no goal, or no cells");
  } else {
    if (certificate->degree != 1 && certificate->degree != 2) fail(REFUSED, "degree must be 1 or 2");
    if (!certificate->motions || certificate->motions >= MOST_MOTIONS) fail(REFUSED, "no motion, or too many");
  }
}

/* Refuse carried files that are cut off, or that no line announces. */
static void require_carried(Certificate* certificate) {
  if ((certificate->carried_size > 0) != (certificate->robot || certificate->scene)) {
    fail(REFUSED, "it carries files and does not say so, or says so and does not");
  }
  for (size_t at = 0, left = certificate->carried_size; left;) {
    uint64_t size = left < 8 ? UINT64_MAX : little_endian(certificate->carried + at, 8);
    if (left < 8 || size > left - 8) fail(REFUSED, "a file that it carries is cut off");
    ++certificate->carried_count;
    at += 8 + (size_t)size;
    left -= 8 + (size_t)size;
  }
}

/* Read the lines of a header. */
static void read_header(Certificate* to, char* text) {
  size_t lines = 1;
  for (const char* each = text; *each; ++each) lines += *each == '\n';
  to->joints = take(lines, sizeof *to->joints);
  to->held = take(lines, sizeof *to->held);
  to->padding = take(lines, sizeof *to->padding);
  to->trees = take(lines, sizeof *to->trees);
  to->poses = take(lines, sizeof *to->poses);
  to->kept = take(lines + 1, sizeof *to->kept);
  to->limits = take(lines, sizeof *to->limits);
  bool seen[ONCE] = {false};
  while (*text) {
    char* line = text;
    text += strcspn(text, "\n");
    if (*text) *text++ = 0;
    read_line(to, line, seen);
  }
  require_counts(to, seen);
}

/* The next bytes of a body, of `count` items; no product overflows: counts have 9 digits, a header 2^16 bytes. */
static const uint8_t* next_bytes(const uint8_t** body, uint64_t* left, uint64_t count, uint64_t size) {
  const uint8_t* from = *body;
  if (count * size > *left) fail(REFUSED, "it is cut off");
  *body += count * size;
  *left -= count * size;
  return from;
}

size_t bytes_of_answer(const Certificate* certificate, const Tree* tree) {
  return 1 + tree->column_count + certificate->witness_count > 256 ? 2 : 1;
}

static void read_values(Certificate* to, const uint8_t* data) {
  size_t numbers = to->points * to->joint_count;
  to->values = take(numbers, sizeof *to->values);
  for (size_t i = 0; i < numbers; ++i) {
    uint64_t bits = little_endian(data + 8 * i, 8);
    memcpy(to->values + i, &bits, sizeof bits);
    if (!(fabs(to->values[i]) <= FARTHEST)) fail(REFUSED, "a value that is no number or too large");
  }
}

Certificate* read_certificate(File file) {
  Certificate* to = take(1, sizeof *to);
  const char* text = (const char*)file.data;
  to->of_no_path = !strncmp(text, OF_NO_PATH, sizeof OF_NO_PATH - 1);
  to->of_pairs = !strncmp(text, OF_PAIRS, sizeof OF_PAIRS - 1);
  size_t size = (to->of_no_path ? sizeof OF_NO_PATH : to->of_pairs ? sizeof OF_PAIRS : sizeof MAGIC) - 1;
  if (!to->of_no_path && !to->of_pairs && strncmp(text, MAGIC, size) != 0) fail(REFUSED, "no certificate");
  const char* end = strstr(text + size - 1, "\n\n");
  if (!end || end - text > LONGEST_HEADER) fail(REFUSED, "a header without end");
  size_t length = (size_t)(end - text);
  read_header(to, copied(text + size, length > size ? length - size : 0));
  const uint8_t* body = file.data + length + 2;
  uint64_t left = file.size - length - 2, packed = (to->answer_count + 2) / 3;
  to->points = to->of_pairs ? 0 : to->of_no_path ? 1 + to->goals : to->degree * to->motions + 1;
  read_values(to, next_bytes(&body, &left, to->points, 8 * to->joint_count));
  to->answers = next_bytes(&body, &left, packed, 1);
  to->directions = next_bytes(&body, &left, to->direction_count, 12);
  to->balls = next_bytes(&body, &left, to->ball_count, 18);
  to->witnesses = next_bytes(&body, &left, to->witness_count, 4);
  for (size_t i = 0; i < to->tree_count; ++i) {
    Tree* tree = to->trees + i;
    tree->answers = next_bytes(&body, &left, tree->answer_count, bytes_of_answer(to, tree));
  }
  to->carried = body;
  to->carried_size = left;
  require_carried(to);
  for (size_t i = 0; i < 3 * packed; ++i) {
    int answer = answer_at(to, i);
    if (to->answers[i / 3] >= 216 || (i >= to->answer_count && answer)) fail(REFUSED, "answers are 0 to 5");
  }
  return to;
}

int answer_at(const Certificate* certificate, size_t index) {
  static const int steps[] = {1, 6, 36};
  return certificate->answers[index / 3] / steps[index % 3] % 6;
}

float float_at(const uint8_t* data) {
  uint32_t bits = (uint32_t)little_endian(data, 4);
  float number = 0;
  memcpy(&number, &bits, sizeof bits);
  return number;
}

Vector direction_at(const Certificate* certificate, size_t index) {
  float numbers[3];
  for (int i = 0; i < 3; ++i) {
    numbers[i] = float_at(certificate->directions + 12 * index + 4 * (size_t)i);
    if (!(fabsf(numbers[i]) <= 2)) fail(REFUSED, "a direction that is no number or too long");
  }
  Vector direction = {numbers[0], numbers[1], numbers[2]};
  double size = length(direction);
  if (!(size > 1e-6)) fail(REFUSED, "a direction without a length");
  return scaled(1 / size, direction);
}
