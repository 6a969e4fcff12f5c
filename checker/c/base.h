/* What all parts of the checker share: memory, errors, numbers, vectors and poses; trees of text; files. */
#ifndef EVENROAD_BASE_H
#define EVENROAD_BASE_H

#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define NONE SIZE_MAX
#define PI 3.14159265358979323846

/* How a check ends: the exit codes of the command. */
enum { ACCEPTED = 0, REFUSED = 1, BAD_INPUT = 2 };

/* Where `fail` jumps to, and the line that it leaves. */
extern jmp_buf on_failure;
extern char failure[400];

/* Leave the check: REFUSED is a certificate that proves nothing, BAD_INPUT a file that cannot be read. */
#if defined(__GNUC__)
__attribute__((noreturn, format(printf, 2, 3)))
#endif
void fail(int code, const char* format, ...);

/* Zeroed memory for `count` items; `release` frees all that was taken since `mark`. */
void* take(size_t count, size_t size);
void* mark(void);
void release(void* since);

/* A piece of text that ends with a 0 byte, copied; and three texts in a row. */
char* copied(const char* text, size_t length);
char* joined(const char* first, const char* second, const char* third);

/* Exactly `count` decimal numbers below 1e9, apart by blanks; without them the first is false, the second one fails. */
bool are_numbers(const char* text, double* numbers, size_t count);
void read_numbers(const char* text, double* numbers, size_t count, const char* where);

/* Sort numbers by qsort; and the first item of the group of one, in which each leads on to another. */
int by_number(const void* a, const void* b);
size_t first_of(size_t* group, size_t item);

/* A number of a few bytes, the lowest first. */
uint64_t little_endian(const uint8_t* data, int bytes);

typedef struct {
  double x, y, z;
} Vector;

/* The axes of a frame, and its origin, seen from another frame. */
typedef struct {
  Vector x, y, z, at;
} Pose;

static inline Vector sum(Vector a, Vector b) { return (Vector){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline Vector difference(Vector a, Vector b) { return (Vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline Vector scaled(double factor, Vector a) { return (Vector){factor * a.x, factor * a.y, factor * a.z}; }
static inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double length(Vector a) { return sqrt(dot(a, a)); }
static inline Vector cross(Vector a, Vector b) {
  return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* A direction and a point of a frame, seen from outside; and a direction from outside, seen in the frame. */
static inline Vector turned(const Pose* pose, Vector a) {
  return sum(scaled(a.x, pose->x), sum(scaled(a.y, pose->y), scaled(a.z, pose->z)));
}
static inline Vector placed(const Pose* pose, Vector a) { return sum(turned(pose, a), pose->at); }
static inline Vector turned_in(const Pose* pose, Vector a) {
  return (Vector){dot(pose->x, a), dot(pose->y, a), dot(pose->z, a)};
}

Pose composed(const Pose* outer, const Pose* inner);
Pose identity(void);
Pose pose_of_turn(Vector axis, double angle);
Pose pose_of_angles(const double rpy[3], Vector at);      /* about the fixed x, then y, then z */
Pose pose_of_quaternion(const double xyzw[4], Vector at); /* of any length but 0 */

enum { MAPPING = 1, LIST, SCALAR };

/* An element of XML, without the prefix of its name (attributes are children as "@name"), or a value of YAML: items of
   a list have no key, and its text has those of its items, apart by blanks. */
typedef struct Entry {
  const char *key, *text;
  int kind;
  struct Entry *child, *last, *next;
} Entry;

Entry* parse_xml(const char* text, size_t length, const char* file);
Entry* parse_yaml(const char* text, size_t length, const char* file);
Entry* append(Entry* parent, const char* key, const char* text, int kind);
void refuse_equal_keys(const Entry* mapping, const char* file);

/* The first child of this key, or NULL; and the same, where a second one is bad input. */
Entry* child_of(const Entry* entry, const char* key);
Entry* only_child_of(const Entry* entry, const char* key);

/* The text of a child: or `otherwise`, or it is bad input. */
const char* text_of(const Entry* entry, const char* key, const char* otherwise);
const char* required(const Entry* entry, const char* key, const char* where);

/* Numbers of a child, which keep their values if there is none; tell whether there is one. */
bool numbers_of(const Entry* entry, const char* key, double* numbers, size_t count, const char* where);

typedef struct {
  const uint8_t* data; /* a 0 byte follows the last one */
  size_t size;
} File;

typedef struct {
  uint32_t state[8];
  uint8_t block[64];
  uint64_t size;
} Sha256;

/* A file that a certificate carries, and the name that others have for it. */
typedef struct {
  const char* name;
  File file;
} Carried;

/* Where files come from, and the digest of the digests of all that were read. */
typedef struct {
  Sha256 hash;
  const char* const* packages; /* as "NAME=FOLDER" */
  size_t package_count;
  const uint8_t* carried; /* by the certificate: each after its length */
  size_t left;
  Carried* taken; /* of those that are carried */
  size_t taken_count;
  bool own; /* whether the next carried file stands for the one that is asked for */
} Files;

File read_file(const char* path); /* of at most a gigabyte */
File next_file(Files* files, const char* path);
void sha256_begin(Sha256* hash);
void sha256_end(Sha256* hash, uint8_t digest[32]);
char* digest_of(File file); /* in hexadecimal digits */

/* The folder of a file: all up to its last slash. */
char* folder_of(const char* path);

/* Write files into a folder; a number goes before the name of one that another file has. */
void write_files(const char* folder, const Carried* files, size_t count);
bool exists(const char* path);

#endif
