/* Nodes: sets of convex elements in one frame, their boxes, their halves and their support functions. */
#ifndef EVENROAD_NODES_H
#define EVENROAD_NODES_H

#include "inputs.h"

/* How far a plane reaches, about the root and below it [m]. */
#define GROUND 100.0

/* What elements of one shape have in common: how many corners, and what is about each. */
typedef struct {
  const Shape* shape;
  size_t corners;
  double ball, disc;
  Vector axis;       /* of the disc, in the frame */
  const Vector* all; /* corners of all its elements, in the frame */
  size_t elements;
  bool* met; /* of a mesh, the open pieces whose boxes hold a point of another body */
} Solid;

typedef struct {
  const Vector* corners;
  const Solid* solid;
  size_t order;
} Element;

typedef struct Node {
  Element* elements;
  size_t count, frame;
  Vector centre, half[3]; /* of the box */
  double reach;           /* the largest distance of a point from the frame's origin */
  struct Node *first, *second;
  Solid** solids; /* of a whole node */
  size_t solid_count;
} Node;

/* The solid of a shape, where its frame is; without elements if the shape is of no size. */
Solid solid_of(const Shape* shape, const Pose* pose);

/* The largest distance of a point of a solid from the frame's origin. */
double reach_of(const Solid* solid);

/* A node of all elements of solids. */
Node* node_of(Solid** solids, size_t count, size_t frame);

/* The first or second half of a node; NULL of a single element. */
Node* half_of(Node* node, bool second);

/* The largest value of `direction . x` over a node, or over its box. */
double support(const Node* node, Vector direction, bool by_box);

#endif
