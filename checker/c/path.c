/* The table of a path or of a trajectory, which must be what a certificate is about. */
#include <string.h>

#include "verify.h"

enum { FINE = 64 }; /* parts of a curve, in which what is near it is looked for */

static const double STILL = 1e-9; /* how near values count as the same */
static const double EXCEEDING =
    1e-6; /* by how much a limit may be exceeded, and the share of a step that steps differ by */
static const char TIME[] = "time [s]";

bool is_straight(const Certificate* certificate) {
  size_t joints = certificate->joint_count;
  for (size_t i = 0; certificate->degree == 2 && i < certificate->motions * joints; ++i) {
    const double* p = certificate->values + 2 * (i / joints) * joints + i % joints;
    if (!(fabs(p[joints] - 0.5 * (p[0] + p[2 * joints])) < 1e-12)) return false;
  }
  return true;
}

/* What a column of a table says: the value of a joint of the certificate, of another one, or nothing of a place. */
typedef struct {
  size_t joint; /* or NONE */
  bool skipped, is_time;
  double held;
} Column;

/* Cut a text at the next mark; NULL at its end. */
static char* next_part(char** text, const char* marks) {
  char* part = *text;
  if (!part) return NULL;
  char* end = part + strcspn(part, marks);
  *text = *end ? end + 1 : NULL;
  *end = 0;
  return part;
}

static Column column_named(const Certificate* certificate, char* name) {
  static const char unit[] = " [rad or m]";
  size_t size = strlen(name), width = sizeof unit - 1;
  Column column = {.joint = NONE, .is_time = !strcmp(name, TIME)};
  column.skipped = column.is_time || strstr(name, "/s");
  if (size >= width && !strcmp(name + size - width, unit)) name[size - width] = 0;
  for (size_t i = 0; i < certificate->joint_count && !column.skipped; ++i) {
    if (!strcmp(certificate->joints[i], name)) column.joint = i;
  }
  for (size_t i = 0; i < certificate->held_count; ++i) {
    if (!strcmp(certificate->held[i].name, name)) column.held = certificate->held[i].value;
  }
  return column;
}

/* Read the first line: each joint of the certificate must have one column. */
static Column* columns_of(const Certificate* certificate, char* line, size_t* count, const char* path) {
  Column* columns = take(strlen(line) + 1, sizeof *columns);
  size_t *seen = take(certificate->joint_count, sizeof *seen), times = 0;
  for (char* name; (name = next_part(&line, ","));) {
    Column column = columns[(*count)++] = column_named(certificate, name);
    if (column.joint != NONE) ++seen[column.joint];
    times += column.is_time;
  }
  if (certificate->limit_count && times != 1) fail(REFUSED, "%s has no times, or two columns of them", path);
  for (size_t i = 0; i < certificate->joint_count; ++i) {
    if (seen[i] != 1) fail(REFUSED, "%s has other joints than the certificate", path);
  }
  return columns;
}

/* Read rows of values as the points of the certificate have them, and their times. */
static double* rows_of(const Certificate* certificate, const char* path, size_t* count, double** times) {
  File file = read_file(path);
  char *text = copied((const char*)file.data, file.size), *line = next_part(&text, "\r\n");
  if (memchr(file.data, 0, file.size)) fail(BAD_INPUT, "%s is no table", path);
  while (line && !*line) line = next_part(&text, "\r\n");
  if (!line) fail(BAD_INPUT, "%s is no table", path);
  size_t joints = certificate->joint_count, column_count = 0, lines = 2;
  for (const char* each = text; each && *each; ++each) lines += *each == '\n' || *each == '\r';
  Column* columns = columns_of(certificate, line, &column_count, path);
  double* rows = take(lines * joints, sizeof *rows);
  *times = take(lines, sizeof **times);
  while ((line = next_part(&text, "\r\n"))) {
    size_t column = 0;
    if (!*line) continue;
    for (char* cell; (cell = next_part(&line, ",")); ++column) {
      double value = 0;
      if (column == column_count) fail(BAD_INPUT, "%s is no table", path);
      read_numbers(cell, &value, 1, path);
      const Column* of = columns + column;
      if (of->is_time) (*times)[*count] = value;
      if (of->joint != NONE) rows[*count * joints + of->joint] = value;
      if (of->joint == NONE && !of->skipped && !(fabs(value - of->held) <= STILL)) {
        fail(REFUSED, "%s has a joint elsewhere than the certificate", path);
      }
    }
    if (column != column_count) fail(BAD_INPUT, "%s is no table", path);
    ++*count;
  }
  return rows;
}

/* The curves as a chain of `FINE` straight parts each: its end number `index`. */
static void find_place(const Certificate* certificate, size_t index, double* place) {
  size_t joints = certificate->joint_count, degree = certificate->degree, motion = index / FINE;
  double t = (double)(index % FINE) / FINE;
  if (motion == certificate->motions) --motion, t = 1;
  for (size_t i = 0; i < joints; ++i) {
    const double* p = certificate->values + motion * degree * joints + i;
    double last = p[degree * joints], middle = degree == 2 ? p[joints] : 0.5 * (p[0] + last);
    place[i] = (1 - t) * (1 - t) * p[0] + 2 * t * (1 - t) * middle + t * t * last;
  }
}

/* How far a point is from a straight way. */
static double away(const double* point, const double* a, const double* b, size_t joints) {
  double along = 0, square = 0, all = 0;
  for (size_t i = 0; i < joints; ++i) {
    along += (point[i] - a[i]) * (b[i] - a[i]);
    square += (b[i] - a[i]) * (b[i] - a[i]);
  }
  double share = square > 0 ? fmin(1, fmax(0, along / square)) : 0;
  for (size_t i = 0; i < joints; ++i) all += pow(point[i] - a[i] - share * (b[i] - a[i]), 2);
  return sqrt(all);
}

/* How far a curve strays from its straight parts: an eighth of its second derivative times their length squared. */
static double strays(const Certificate* certificate) {
  size_t joints = certificate->joint_count;
  double most = 0;
  for (size_t motion = 0; certificate->degree == 2 && motion < certificate->motions; ++motion) {
    const double* p = certificate->values + 2 * motion * joints;
    double square = 0;
    for (size_t i = 0; i < joints; ++i) square += pow(2 * (p[i] - 2 * p[joints + i] + p[2 * joints + i]), 2);
    most = fmax(most, sqrt(square));
  }
  return most / FINE / FINE / 8;
}

/* How far a spline strays from the straight ways between its control points: an eighth of their second difference. */
static double spline_strays(const double* rows, size_t count, size_t joints) {
  double most = 0;
  for (size_t i = 1; i + 1 < count; ++i) {
    double square = 0;
    for (size_t k = i * joints; k < (i + 1) * joints; ++k) {
      square += pow(rows[k + joints] - 2 * rows[k] + rows[k - joints], 2);
    }
    most = fmax(most, sqrt(square) / 8);
  }
  return most;
}

/* Tell whether rows, and the straight ways between them, follow the curves within their tolerance; and, if there are
   limits, the spline of which they hold. */
static bool are_near(const Certificate* certificate, const double* rows, size_t count) {
  size_t joints = certificate->joint_count, at = 0, last = certificate->motions * FINE;
  double near = certificate->tolerance - strays(certificate);
  if (certificate->limit_count) near -= spline_strays(rows, count, joints);
  double* places = take(3 * joints, sizeof *places); /* the ends of the part that a row is near, and the next one */
  for (size_t k = 0; k < 3; ++k) find_place(certificate, k, places + k * joints);
  for (size_t i = 0; i < count; ++i) {
    const double *row = rows + i * joints, *before = i ? row - joints : row;
    while (at + 2 <= last &&
           away(row, places + joints, places + 2 * joints, joints) < away(row, places, places + joints, joints)) {
      memmove(places, places + joints, 2 * joints * sizeof *places);
      if (++at + 2 <= last) find_place(certificate, at + 2, places + 2 * joints);
      if (!(away(places, before, row, joints) <= near)) return false;
    }
    if (!(away(row, places, places + joints, joints) <= near)) return false;
  }
  find_place(certificate, last, places);
  return count && away(places, rows + (count - 1) * joints, rows + (count - 1) * joints, joints) <= near;
}

/* Refuse rows that exceed a limit, as control points of a spline of degree 2 in time, the first and last ones twice. */
static void require_slow(const Certificate* certificate, const double* rows, const double* times, size_t count) {
  size_t joints = certificate->joint_count;
  double least = INFINITY, most = 0;
  for (size_t i = 1; i < count; ++i) {
    least = fmin(least, times[i] - times[i - 1]);
    most = fmax(most, times[i] - times[i - 1]);
  }
  if (count < 2 || !(least > 0 && most <= (1 + EXCEEDING) * least)) fail(REFUSED, "times do not rise by equal steps");
  for (size_t k = 0; k < certificate->limit_count; ++k) {
    const Limit* limit = certificate->limits + k;
    const double* at = rows + column_of(certificate, limit->name);
    double before = 0;
    for (size_t i = 1; i <= count; ++i) {
      double velocity = i < count ? (at[i * joints] - at[(i - 1) * joints]) / least : 0;
      bool keeps = fabs(velocity) <= limit->velocity + EXCEEDING;
      keeps = keeps && fabs(velocity - before) / least <= limit->acceleration + EXCEEDING;
      if (!keeps) fail(REFUSED, "%.60s exceeds its limit of velocity or acceleration", limit->name);
      before = velocity;
    }
  }
}

void require_same_path(const Certificate* certificate, const char* path) {
  size_t count = 0, joints = certificate->joint_count;
  double* times = NULL;
  const double* rows = rows_of(certificate, path, &count, &times);
  if (certificate->limit_count) require_slow(certificate, rows, times, count);
  if (certificate->tolerance > 0) {
    if (!are_near(certificate, rows, count)) fail(REFUSED, "%s leaves the curves of the certificate", path);
    return;
  }
  if (certificate->limit_count) fail(REFUSED, "limits of a spline near the waypoints, and no tolerance");
  if (!is_straight(certificate)) fail(REFUSED, "it proves curves, which no table of waypoints gives");
  bool same = count == certificate->motions + 1;
  for (size_t i = 0; same && i < count * joints; ++i) {
    same = rows[i] == certificate->values[i / joints * certificate->degree * joints + i % joints];
  }
  if (!same) fail(REFUSED, "%s has other waypoints than the certificate", path);
}

void require_end(const Certificate* certificate, const char* name, const char* said, size_t first, size_t count) {
  size_t joints = certificate->joint_count;
  double* state = take(joints, sizeof *state);
  bool same = false;
  if (!said) return;
  read_numbers(said, state, joints, name);
  for (size_t i = first; i < first + count && !same; ++i) {
    same = true;
    for (size_t k = 0; k < joints; ++k) {
      same = same && fabs(certificate->values[i * joints + k] - state[k]) <= STILL;
    }
  }
  if (!same) fail(REFUSED, "it is about another %s", name);
}
