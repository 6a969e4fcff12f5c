/* Cells of the ranges of some joints: which of them are open, and which goals they shut off from the start. */
#ifndef EVENROAD_CELLS_H
#define EVENROAD_CELLS_H

#include "witnesses.h"

enum { MOST_COLUMNS = 8, UNITS = 1 << 24 };

/* A box of the columns of a tree, in units. */
typedef struct {
  uint32_t low[MOST_COLUMNS], high[MOST_COLUMNS];
} Cell;

/* The columns of a tree: what their ranges are, and which have none. */
typedef struct {
  size_t count, columns[MOST_COLUMNS];
  double range[MOST_COLUMNS][2];
  bool endless[MOST_COLUMNS];
} Axes;

/* Whether a cell holds a configuration. */
bool holds(const Axes* axes, const Cell* cell, const double* point);

/* For each open cell, whether the start reaches it; refuses a start that is in none. */
bool* reached_from(const double* start, const Axes* axes, const Cell* open, size_t count);

/* What proves that there is no path. */
typedef struct {
  const Model* model;
  double smallest; /* overlap of a cell [m] */
  size_t blocked;
  const Witness* witnesses;
  bool* columns; /* that a tree has */
} NoPath;

NoPath verify_no_path(const Inputs* inputs, const Certificate* certificate);

#endif
