/* What all parts of the checker share: memory, errors, numbers, vectors and poses. */
#ifndef EVENROAD_BASE_H
#define EVENROAD_BASE_H

#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/* A piece of text that ends with a 0 byte, copied. */
char* copied(const char* text, size_t length);

/* Exactly `count` decimal numbers below 1e9, apart by blanks; fails with `where` in its line. */
void read_numbers(const char* text, double* numbers, size_t count, const char* where);

typedef struct {
  double x, y, z;
} Vector;

/* The axes of a frame, and its origin, seen from another frame. */
typedef struct {
  Vector x, y, z, at;
} Pose;

Vector sum(Vector a, Vector b);
Vector difference(Vector a, Vector b);
Vector scaled(double factor, Vector a);
Vector cross(Vector a, Vector b);
double dot(Vector a, Vector b);
double length(Vector a);
Vector turned(const Pose* pose, Vector a);    /* a direction of the frame, seen from outside */
Vector placed(const Pose* pose, Vector a);    /* a point of the frame, seen from outside */
Vector turned_in(const Pose* pose, Vector a); /* a direction from outside, seen in the frame */
Pose composed(const Pose* outer, const Pose* inner);
Pose identity(void);
Pose pose_of_angles(const double rpy[3], Vector at);      /* about the fixed x, then y, then z */
Pose pose_of_quaternion(const double xyzw[4], Vector at); /* of any length but 0 */
Pose pose_of_turn(Vector axis, double angle);

#endif
