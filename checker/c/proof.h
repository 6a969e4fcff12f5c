/* The proof: the tasks that a checker makes, and what the certificate answers to each. */
#ifndef EVENROAD_PROOF_H
#define EVENROAD_PROOF_H

#include "model.h"

/* The part of a motion that is `half` to both sides of its middle; or a diagonal of a cell, by the middle of each
   column and half of its side. */
typedef struct {
  size_t motion, number; /* of each that is begun, from 1 */
  double middle, half;
  double (*cell)[2];
} Stretch;

/* A frame at one time, and how its joint moves it there, seen from the root. */
typedef struct {
  Pose pose;
  Vector axis;
  double rate, change, fastest; /* of its joint: derivatives by the part of the motion, and the largest rate */
  size_t stretch;               /* the number of that in whose middle it is */
} Moved;

/* Place a frame, and all on its chain, in the middle of a stretch, unless they are there. */
void place_chain(const Model* model, size_t frame, const Stretch* stretch, Moved* moved);

/* Place one frame, by the value of its column, behind those above it. */
void place_frame(const Model* model, size_t frame, double value, Moved* moved);

/* The last frame that the chains of two others have in common. */
size_t shared(const Model* model, size_t a, size_t b);

/* Answer all tasks, or refuse; return the smallest gap that a step of the proof leaves. */
double prove(Model* model);

#endif
