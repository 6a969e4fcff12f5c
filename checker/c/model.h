/* What a certificate is about: the frames that its joints move, the bodies in them, and the pairs to be proved. */
#ifndef EVENROAD_MODEL_H
#define EVENROAD_MODEL_H

#include "certificate.h"
#include "inputs.h"
#include "nodes.h"

enum { MOST_MOVING = 6 };

/* A frame behind a joint that moves; frame 0 is the root's. */
typedef struct {
  const Joint* joint;
  size_t parent, column; /* of the points */
  double multiplier, offset;
  Pose fixed; /* of the joint, in the parent's frame */
  Vector axis;
  bool slides;
  double length; /* from the parent's origin to the joint, and the largest slide */
} Frame;

/* Where a link is: its frame, and its pose there. */
typedef struct {
  size_t link, frame;
  Pose pose;
} Place;

typedef struct {
  const char* name;
  size_t frame, link, attached; /* NONE for what is no link, or is not attached */
  double padding;
  Solid** solids;
  size_t count;
  bool* allowed; /* for each obstacle */
  Node* node;
} Body;

/* Two nodes that must stay apart: some bodies and the obstacles, or two bodies; of a certificate of pairs those of a
   line, and the columns that move them against each other. */
typedef struct {
  Node *first, *second;
  double margin;
  size_t a, b; /* bodies; of obstacles b is NONE, and `group` names the first body of a */
  bool apart;  /* as wholes, at some time */
  const Tree* line;
  size_t moving[MOST_MOVING], moving_count;
} Pair;

typedef struct {
  const Inputs* inputs;
  const Certificate* certificate;
  Frame* frames;
  Body* bodies;
  Pair* pairs;
  double (*ranges)[2];    /* how far the joints of the points may go: infinitely far without limits */
  const double* extremes; /* of the joints, as rows like the points */
  size_t extreme_count;
  size_t* order;        /* of links, depth first */
  const Place* of_link; /* for each link */
  size_t* group;        /* of each body, the first body of its node against obstacles */
  size_t frame_count, pair_count;
  size_t most_moved;            /* the largest number of joints that one column moves */
  size_t body_count, all_count; /* all: with the obstacles, which are bodies of frame 0 behind those of the robot */
} Model;

/* Refuse a column without a range, and one that is endless and does not come back after a turn. */
void require_range(const Model* model, size_t column);

/* Where the link of a constraint or goal is; refuses a link that there is not. */
const Place* place_of_link(const Model* model, const char* link);

Model* model_of(const Inputs* inputs, const Certificate* certificate);

#endif
