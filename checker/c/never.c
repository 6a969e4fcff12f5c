#include "never.h"

/* Add the columns of a chain that a pair does not know yet. */
static void add_moving(const Model* model, Pair* pair, size_t frame, size_t from) {
  for (; frame != from; frame = model->frames[frame].parent) {
    size_t column = model->frames[frame].column, i = 0;
    while (i < pair->moving_count && pair->moving[i] != column) ++i;
    if (i < pair->moving_count) continue;
    if (i == MOST_MOVING) fail(REFUSED, "too many joints between two links");
    require_range(model, column);
    pair->moving[pair->moving_count++] = column;
  }
}

void find_named_pairs(Model* model) {
  const Certificate* certificate = model->certificate;
  model->pairs = take(certificate->tree_count, sizeof *model->pairs);
  for (; model->pair_count < certificate->tree_count; ++model->pair_count) {
    const Tree* line = certificate->trees + model->pair_count;
    for (size_t i = 0; i < line->column_count; ++i) {
      size_t known = i < 2 ? model->body_count : certificate->joint_count;
      if (line->columns[i] >= known) fail(REFUSED, "a pair of an unknown link or joint");
    }
    if (line->column_count < 2) fail(REFUSED, "a pair of one link");
    Pair pair = {.a = line->columns[0], .b = line->columns[1], .line = line};
    const Body *a = model->bodies + pair.a, *b = model->bodies + pair.b;
    size_t from = shared(model, a->frame, b->frame);
    pair.first = a->node;
    pair.second = b->node;
    add_moving(model, &pair, a->frame, from);
    add_moving(model, &pair, b->frame, from);
    if (!pair.moving_count) fail(REFUSED, "no joint is between two links");
    model->pairs[model->pair_count] = pair;
  }
}

double (*lowest_cell(const Model* model))[2] {
  double (*cell)[2] = take(model->certificate->joint_count, sizeof *cell);
  for (size_t c = 0; c < model->certificate->joint_count; ++c) cell[c][0] = model->extremes[c];
  return cell;
}

void begin_cell(const Model* model, const Pair* pair, size_t level, uint64_t index, size_t back, Stretch* stretch) {
  size_t joints = model->certificate->joint_count, halved = pair->line->column_count - 2;
  double (*cell)[2] = stretch->cell;
  for (size_t c = 0; c < joints; ++c) {
    cell[c][0] = model->extremes[c];
    cell[c][1] = model->extremes[joints + c] - cell[c][0];
  }
  for (size_t i = 0; i < level && i < halved; ++i) {
    double* side = cell[pair->line->columns[i + 2]];
    side[1] /= 2;
    if (index >> (level - 1 - i) & 1) side[0] += side[1];
  }
  for (size_t c = 0; c < joints; ++c) {
    cell[c][1] /= 2;
    cell[c][0] += cell[c][1];
  }
  for (size_t i = 1; i < pair->moving_count; ++i) {
    if (back >> (i - 1) & 1) cell[pair->moving[i]][1] *= -1;
  }
  *stretch = (Stretch){.number = stretch->number + 1, .half = 1, .cell = cell};
}
