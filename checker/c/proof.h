/* The proof: the tasks that a checker makes, and what the certificate answers to each. */
#ifndef EVENROAD_PROOF_H
#define EVENROAD_PROOF_H

#include "model.h"

/* A frame at one time, and how its joint moves it there, seen from the root. */
typedef struct {
  Pose pose;
  Vector axis;
  double rate, change, fastest; /* of its joint: derivatives by the part of the motion, and the largest rate */
} Moved;

/* Place all frames at the part `middle` of a motion, with rates in the stretch `half` to both sides. */
void place_frames(const Model* model, size_t motion, double middle, double half, Moved* moved);

/* Place one frame, by the value of its column, behind those above it. */
void place_frame(const Model* model, size_t frame, double value, Moved* moved);

/* The last frame that the chains of two others have in common. */
size_t shared(const Model* model, size_t a, size_t b);

/* Answer all tasks, or refuse; return the smallest gap that a step of the proof leaves. */
double prove(Model* model);

#endif
