#include "certificate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char MAGIC[] = "evenroad certificate 1";

enum { ONCE = 8, LONGEST_HEADER = 1 << 16, MOST_MOTIONS = 1 << 20 };

static const double FARTHEST = 1000;

static size_t count_of(const char* text) {
  size_t width = strspn(text, "0123456789");
  if (!width || width > 9 || text[width]) fail(REFUSED, "no count: %.20s", text);
  return strtoul(text, NULL, 10);
}

static double number_of(const char* text) {
  double number = 0;
  if (!*text || text[strspn(text, "0123456789+-.eE")]) fail(REFUSED, "no number: %.40s", text);
  read_numbers(text, &number, 1, "the certificate");
  return number;
}

static double length_of(const char* text) {
  double number = number_of(text);
  if (!(number >= 0 && number <= 1)) fail(REFUSED, "a length must be 0 to 1 m: %.20s", text);
  return number;
}

/* A value and a name behind it. */
static Named named(char* text) {
  char* blank = strchr(text, ' ');
  if (!blank) fail(REFUSED, "no name: %.60s", text);
  *blank = 0;
  return (Named){blank + 1, number_of(text)};
}

static void add_named(Named* list, size_t* count, Named one) {
  for (size_t i = 0; i < *count; ++i) {
    if (!strcmp(list[i].name, one.name)) fail(REFUSED, "named twice: %.60s", one.name);
  }
  list[(*count)++] = one;
}

static void read_digest(Certificate* to, const char* text) {
  if (strlen(text) != 64 || strspn(text, "0123456789abcdef") != 64) fail(REFUSED, "no digest: %.80s", text);
  for (int i = 0; i < 32; ++i) {
    char two[3] = {text[2 * i], text[2 * i + 1], 0};
    to->digest[i] = (uint8_t)strtoul(two, NULL, 16);
  }
}

/* Read one line; those that may stand once only are counted in `seen`. */
static void read_line(Certificate* to, char* line, bool seen[ONCE]) {
  static const char* const once[ONCE] = {"inputs",     "degree",    "motions", "answers",
                                         "directions", "clearance", "robot",   "scene"};
  char* blank = strchr(line, ' ');
  if (!blank) fail(REFUSED, "a line that is not known: %.60s", line);
  *blank = 0;
  char* value = blank + 1;
  for (int i = 0; i < ONCE; ++i) {
    if (strcmp(line, once[i]) != 0) continue;
    if (seen[i]) fail(REFUSED, "said twice: %s", line);
    seen[i] = true;
    if (i == 0) read_digest(to, value);
    if (i == 1) to->degree = count_of(value);
    if (i == 2) to->motions = count_of(value);
    if (i == 3) to->answer_count = count_of(value);
    if (i == 4) to->direction_count = count_of(value);
    if (i == 5) to->clearance = length_of(value);
    if (i == 6) to->robot = value;
    if (i == 7) to->scene = value;
    return;
  }
  if (!strcmp(line, "joint")) {
    for (size_t i = 0; i < to->joint_count; ++i) {
      if (!strcmp(to->joints[i], value)) fail(REFUSED, "joint %.60s is named twice", value);
    }
    to->joints[to->joint_count++] = value;
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

static void require_counts(const Certificate* certificate) {
  if (certificate->degree != 1 && certificate->degree != 2) fail(REFUSED, "degree must be 1 or 2");
  if (!certificate->joint_count) fail(REFUSED, "no joint is named");
  if (!certificate->motions || certificate->motions >= MOST_MOTIONS) fail(REFUSED, "no motion, or too many");
}

/* Refuse carried files that are cut off, or that no line announces. */
static void require_carried(const Certificate* certificate) {
  if ((certificate->carried_size > 0) != (certificate->robot || certificate->scene)) {
    fail(REFUSED, "it carries files and does not say so, or says so and does not");
  }
  for (size_t at = 0, left = certificate->carried_size; left;) {
    uint64_t size = left < 8 ? UINT64_MAX : little_endian(certificate->carried + at, 8);
    if (left < 8 || size > left - 8) fail(REFUSED, "a file that it carries is cut off");
    at += 8 + (size_t)size;
    left -= 8 + (size_t)size;
  }
}

Certificate* read_certificate(File file) {
  Certificate* to = take(1, sizeof *to);
  const char* start = (const char*)file.data;
  size_t size = sizeof MAGIC - 1;
  if (file.size <= size || memcmp(start, MAGIC, size) != 0 || start[size] != '\n') fail(REFUSED, "no certificate");
  const char* end = strstr(start + size, "\n\n");
  if (!end || end - start > LONGEST_HEADER) fail(REFUSED, "a header without end");
  char* text = copied(start + size + 1, (size_t)(end - start) > size ? (size_t)(end - start) - size : 0);
  size_t lines = 0;
  for (const char* each = text; *each; ++each) lines += *each == '\n';
  to->joints = take(lines + 1, sizeof *to->joints);
  to->held = take(lines + 1, sizeof *to->held);
  to->padding = take(lines + 1, sizeof *to->padding);
  bool seen[ONCE] = {false};
  while (*text) {
    char* line = text;
    text += strcspn(text, "\n");
    if (*text) *text++ = 0;
    read_line(to, line, seen);
  }
  for (int i = 0; i < 5; ++i) {
    if (!seen[i]) fail(REFUSED, "a line is missing");
  }
  require_counts(to);
  const uint8_t* body = (const uint8_t*)end + 2;
  uint64_t left = file.size - (size_t)(body - file.data), numbers = 0;
  to->points = to->degree * to->motions + 1;
  numbers = (uint64_t)to->points * to->joint_count; /* below 2^51: counts have 9 digits, a header a megabyte */
  uint64_t packed = (to->answer_count + 2) / 3;
  uint64_t own = 8 * numbers + packed + 12 * (uint64_t)to->direction_count;
  if (own > left) fail(REFUSED, "it is cut off");
  to->carried = body + own;
  to->carried_size = left - own;
  require_carried(to);
  to->values = take(numbers, sizeof *to->values);
  for (size_t i = 0; i < numbers; ++i) {
    uint64_t bits = little_endian(body + 8 * i, 8);
    memcpy(to->values + i, &bits, sizeof bits);
    if (!(fabs(to->values[i]) <= FARTHEST)) fail(REFUSED, "a value that is no number or too large");
  }
  to->answers = body + 8 * numbers;
  to->directions = to->answers + packed;
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

Vector direction_at(const Certificate* certificate, size_t index) {
  float numbers[3];
  for (int i = 0; i < 3; ++i) {
    uint32_t bits = (uint32_t)little_endian(certificate->directions + 12 * index + 4 * (size_t)i, 4);
    memcpy(numbers + i, &bits, sizeof bits);
    if (!(fabsf(numbers[i]) <= 2)) fail(REFUSED, "a direction that is no number or too long");
  }
  Vector direction = {numbers[0], numbers[1], numbers[2]};
  double size = length(direction);
  if (!(size > 1e-6)) fail(REFUSED, "a direction without a length");
  return scaled(1 / size, direction);
}
