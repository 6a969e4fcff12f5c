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

/* Refuse unless the waypoints of a CSV, whose first row names the joints, are those of the certificate. */
void require_same_path(const Certificate* certificate, const char* path);

/* Print what was proved, about which bodies, and what is not claimed. */
void print_proved(const Proved* proved);
void print_no_path(const NoPath* shown);

#endif
