/* Nodes: sets of convex elements in one frame, their boxes, their halves and their support functions. */
#ifndef EVENROAD_NODES_H
#define EVENROAD_NODES_H

#include "inputs.h"

/* How far a plane reaches, about the root and below it [m]. */
#define GROUND 100.0

typedef struct {
  Vector low, high;
} Range;

/* A shape in a frame: points, which its elements have for corners, and what is about each of them. */
typedef struct {
  const Shape* shape;
  Vector* points;
  size_t point_count, elements;
  double ball, disc;
  Vector axis;   /* of the disc */
  size_t* seen;  /* for each point, the last node that has gathered it */
  Range* ranges; /* of the pieces of a mesh, once they are asked for */
  bool* met;     /* for each piece that is open, whether its range holds a point of another body */
} Solid;

/* A convex element of a node: the mean of its corners as halves have it, their range, and how far they reach. */
typedef struct {
  Solid* solid;
  size_t number; /* in its solid */
  Vector mean;
  Range range;
  double reach;
} Element;

/* Points that have the same about them. */
typedef struct {
  const Solid* solid;
  const Vector* points;
  size_t count;
} Corners;

typedef struct Node {
  Solid** solids; /* of the whole node of which this one is a part */
  size_t solid_count, frame, count;
  Element* elements;      /* of the whole, in order, once it is halved */
  size_t* members;        /* the elements that are in this node, ascending */
  Vector centre, half[3]; /* of the box */
  double reach;           /* the largest distance of a point from the frame's origin */
  Corners* corners;       /* once they are asked for */
  size_t corner_count;
  struct Node *first, *second;
} Node;

/* The solid of a shape, where its frame is. */
Solid solid_of(const Shape* shape, const Pose* pose);

/* Tell whether a solid is made of triangles that are elements; and a corner of an element. */
bool is_surface(const Solid* solid);
Vector corner_at(const Solid* solid, size_t element, size_t corner);

void widen(Range* range, Vector at);

/* The largest distance of a point of a solid from the frame's origin. */
double reach_of(const Solid* solid);

/* A node of all elements of solids. */
Node* node_of(Solid** solids, size_t count, size_t frame);

/* The first or second half of a node; NULL of a single element. */
Node* half_of(Node* node, bool second);

/* The largest values of `direction . x` over a node, or over its box, for two directions. */
void find_supports(Node* node, const Vector directions[2], bool by_box, double supports[2]);

#endif
