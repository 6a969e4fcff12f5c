/* Witnesses: a ball inside of a body, and the solid or ball of another body that it overlaps with. */
#ifndef EVENROAD_WITNESSES_H
#define EVENROAD_WITNESSES_H

#include "model.h"

/* By how much a witness must overlap, and a ball must be deeper than its radius [m]. */
#define SPARE 1e-9

typedef struct {
  size_t body;
  Vector centre;
  double radius;
} Ball;

typedef struct {
  const Ball* ball;
  size_t body;        /* with which it overlaps */
  const Solid* solid; /* of that, or NULL */
  const Ball* other;  /* inside of that, or NULL */
  double kept;        /* what the two bodies keep from each other */
  bool repeats;       /* an earlier witness is about the same bodies */
} Witness;

/* All witnesses of a certificate; refuses a ball that is not inside of its body, and two bodies that may touch. */
Witness* read_witnesses(const Model* model);

/* The distance of a point from a solid that a witness names; less than 0 inside. */
double distance_from(const Solid* solid, Vector point);

#endif
