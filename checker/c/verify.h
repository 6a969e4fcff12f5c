/* The whole check of one certificate. */
#ifndef EVENROAD_VERIFY_H
#define EVENROAD_VERIFY_H

#include "cells.h"

typedef struct {
  const Model* model;
  double smallest; /* gap of a step of the proof [m] */
  size_t opened;   /* pieces with holes, about whose inside nothing is claimed */
} Proved;

/* What a certificate proves about its inputs; fails if it does not. */
Proved verify(const Inputs* inputs, const Certificate* certificate);

/* Tell whether no motion is bent. */
bool is_straight(const Certificate* certificate);

/* Refuse unless the rows of a CSV are the waypoints of a certificate, or follow its curves within their tolerance. */
void require_same_path(const Certificate* certificate, const char* path);

/* Refuse unless a start or goal, if one is said, is one of `count` points of a certificate. */
void require_end(const Certificate* certificate, const char* name, const char* said, size_t first, size_t count);

/* Print what was proved, about which bodies, and what is not claimed. */
void print_proved(const Proved* proved, bool timed); /* whether a table has the times */
void print_never(const Proved* proved);              /* of a certificate of pairs */
void print_no_path(const NoPath* shown);

#endif
