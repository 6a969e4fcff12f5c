#include "cells.h"

#include <stdlib.h>

static const double OUTSIDE = 0.001; /* by how much a cell may miss a configuration that it holds, in units */

enum { MOST_FACES = 1 << 25 };

bool holds(const Axes* axes, const Cell* cell, const double* point) {
  for (size_t i = 0; i < axes->count; ++i) {
    const double* range = axes->range[i];
    double at = (point[axes->columns[i]] - range[0]) / (range[1] - range[0]) * UNITS;
    bool inside = false;
    if (axes->endless[i]) at -= UNITS * floor(at / UNITS);
    for (int turn = -axes->endless[i]; turn <= axes->endless[i]; ++turn) {
      double there = at + turn * (double)UNITS;
      inside = inside || (cell->low[i] - there < OUTSIDE && there - cell->high[i] < OUTSIDE);
    }
    if (!inside) return false;
  }
  return true;
}

/* An open cell, by where it begins along a column. */
typedef struct {
  uint32_t low;
  size_t cell;
} Beginning;

static int by_low(const void* a, const void* b) {
  const Beginning *p = a, *q = b;
  return (p->low > q->low) - (p->low < q->low);
}

/* Tell whether two cells overlap by more than a point along all columns but one. */
static bool share_face(const Axes* axes, const Cell* a, const Cell* b, size_t but) {
  for (size_t i = 0; i < axes->count; ++i) {
    if (i != but && (a->low[i] >= b->high[i] || b->low[i] >= a->high[i])) return false;
  }
  return true;
}

/* The first place of a beginning at `low` or above it. */
static size_t place_of(const Beginning* beginnings, size_t count, uint32_t low) {
  size_t from = 0;
  while (count) {
    size_t half = count / 2;
    if (beginnings[from + half].low < low)
      from += half + 1, count -= half + 1;
    else
      count = half;
  }
  return from;
}

/* Join open cells with their neighbours: `group` leads from each to the first one that it reaches. */
static void join_neighbours(const Axes* axes, const Cell* open, size_t count, size_t* group) {
  Beginning* beginnings = take(count + 1, sizeof *beginnings);
  size_t faces = 0;
  for (size_t i = 0; i < count; ++i) group[i] = i;
  for (size_t axis = 0; axis < axes->count; ++axis) {
    for (size_t i = 0; i < count; ++i) beginnings[i] = (Beginning){open[i].low[axis], i};
    qsort(beginnings, count, sizeof *beginnings, by_low);
    for (size_t i = 0; i < count; ++i) {
      uint32_t end = open[i].high[axis];
      if (end == UNITS && axes->endless[axis]) end = 0;
      for (size_t k = place_of(beginnings, count, end); k < count && beginnings[k].low == end; ++k) {
        if (++faces > MOST_FACES) fail(REFUSED, "more than %d pairs of cells meet", MOST_FACES);
        size_t other = beginnings[k].cell;
        if (share_face(axes, open + i, open + other, axis)) group[first_of(group, other)] = first_of(group, i);
      }
    }
  }
}

bool* reached_from(const double* start, const Axes* axes, const Cell* open, size_t count) {
  size_t* group = take(count + 1, sizeof *group);
  bool *begun = take(count + 1, sizeof *begun), *reached = take(count + 1, sizeof *reached), any = false;
  join_neighbours(axes, open, count, group);
  for (size_t i = 0; i < count; ++i) {
    if (holds(axes, open + i, start)) begun[first_of(group, i)] = any = true;
  }
  if (!any) fail(REFUSED, "the start is in no open cell");
  for (size_t i = 0; i < count; ++i) reached[i] = begun[first_of(group, i)];
  return reached;
}
