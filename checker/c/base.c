#include "base.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

jmp_buf on_failure;
char failure[400];

typedef union Block {
  union Block* earlier;
  double aligned[2];
} Block;

static Block* latest;

void fail(int code, const char* format, ...) {
  va_list values;
  va_start(values, format);
  vsnprintf(failure, sizeof failure, format, values);
  va_end(values);
  for (char* each = failure; *each; ++each) {
    if ((unsigned char)*each < ' ') *each = '?';
  }
  longjmp(on_failure, code);
}

void* take(size_t count, size_t size) {
  if (count > (SIZE_MAX - sizeof(Block)) / size) fail(BAD_INPUT, "too large");
  Block* block = calloc(1, sizeof(Block) + count * size);
  if (!block) fail(BAD_INPUT, "out of memory");
  block->earlier = latest;
  latest = block;
  return block + 1;
}

void* mark(void) { return latest; }

void release(void* since) {
  while (latest != since) {
    Block* block = latest;
    latest = block->earlier;
    free(block);
  }
}

char* copied(const char* text, size_t length) {
  char* copy = take(length + 1, 1);
  memcpy(copy, text, length);
  return copy;
}

char* joined(const char* first, const char* second, const char* third) {
  char* text = take(strlen(first) + strlen(second) + strlen(third) + 1, 1);
  strcat(strcat(strcpy(text, first), second), third);
  return text;
}

int by_number(const void* a, const void* b) {
  const size_t *p = a, *q = b;
  return (*p > *q) - (*p < *q);
}

size_t first_of(size_t* group, size_t item) {
  while (group[item] != item) item = group[item] = group[group[item]];
  return item;
}

uint64_t little_endian(const uint8_t* data, int bytes) {
  uint64_t bits = 0;
  for (int i = bytes; i--;) bits = bits << 8 | data[i];
  return bits;
}

bool are_numbers(const char* text, double* numbers, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    text += strspn(text, " \t\r\n");
    size_t width = strspn(text, "0123456789+-.eE");
    char* end = NULL;
    numbers[i] = strtod(text, &end);
    if (!width || end != text + width || !(fabs(numbers[i]) < 1e9)) return false;
    text = end;
  }
  return !text[strspn(text, " \t\r\n")];
}

void read_numbers(const char* text, double* numbers, size_t count, const char* where) {
  if (!are_numbers(text, numbers, count)) fail(BAD_INPUT, "%s: not %zu numbers: %.40s", where, count, text);
}

Pose composed(const Pose* outer, const Pose* inner) {
  return (Pose){turned(outer, inner->x), turned(outer, inner->y), turned(outer, inner->z), placed(outer, inner->at)};
}

Pose identity(void) { return (Pose){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}; }

Pose pose_of_turn(Vector axis, double angle) {
  double c = cos(angle), s = sin(angle), v = 1 - c;
  return (Pose){{c + v * axis.x * axis.x, v * axis.x * axis.y + s * axis.z, v * axis.x * axis.z - s * axis.y},
                {v * axis.x * axis.y - s * axis.z, c + v * axis.y * axis.y, v * axis.y * axis.z + s * axis.x},
                {v * axis.x * axis.z + s * axis.y, v * axis.y * axis.z - s * axis.x, c + v * axis.z * axis.z},
                {0, 0, 0}};
}

Pose pose_of_angles(const double rpy[3], Vector at) {
  Pose roll = pose_of_turn((Vector){1, 0, 0}, rpy[0]);
  Pose pitch = pose_of_turn((Vector){0, 1, 0}, rpy[1]);
  Pose yaw = pose_of_turn((Vector){0, 0, 1}, rpy[2]);
  Pose inner = composed(&pitch, &roll), pose = composed(&yaw, &inner);
  pose.at = at;
  return pose;
}

Pose pose_of_quaternion(const double xyzw[4], Vector at) {
  Vector axis = {xyzw[0], xyzw[1], xyzw[2]};
  double sine = length(axis);
  if (!(sine + fabs(xyzw[3]) > 0)) fail(BAD_INPUT, "a quaternion of length 0");
  Pose pose = sine > 0 ? pose_of_turn(scaled(1 / sine, axis), 2 * atan2(sine, xyzw[3])) : identity();
  pose.at = at;
  return pose;
}
