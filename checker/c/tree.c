#include <stdlib.h>
#include <string.h>

#include "base.h"

Entry* append(Entry* parent, const char* key, const char* text, int kind) {
  Entry* entry = take(1, sizeof *entry);
  *entry = (Entry){.key = key, .text = text, .kind = kind};
  if (parent->last) {
    parent->last->next = entry;
  } else {
    parent->child = entry;
  }
  parent->last = entry;
  return entry;
}

Entry* child_of(const Entry* entry, const char* key) {
  Entry* each = entry ? entry->child : NULL;
  while (each && !(each->key && !strcmp(each->key, key))) each = each->next;
  return each;
}

Entry* only_child_of(const Entry* entry, const char* key) {
  Entry* found = child_of(entry, key);
  for (const Entry* each = found ? found->next : NULL; each; each = each->next) {
    if (each->key && !strcmp(each->key, key)) fail(BAD_INPUT, "more than one <%s> in <%s>", key, entry->key);
  }
  return found;
}

const char* text_of(const Entry* entry, const char* key, const char* otherwise) {
  const Entry* found = child_of(entry, key);
  return found ? found->text : otherwise;
}

const char* required(const Entry* entry, const char* key, const char* where) {
  const char* text = text_of(entry, key, NULL);
  if (!text) fail(BAD_INPUT, "%s: no %s", where, key + (*key == '@'));
  return text;
}

bool numbers_of(const Entry* entry, const char* key, double* numbers, size_t count, const char* where) {
  const char* text = text_of(entry, key, NULL);
  if (text) read_numbers(text, numbers, count, where);
  return text != NULL;
}

static int by_key(const void* a, const void* b) { return strcmp((*(Entry* const*)a)->key, (*(Entry* const*)b)->key); }

void refuse_equal_keys(const Entry* mapping, const char* file) {
  size_t count = 0, i = 0;
  for (const Entry* each = mapping->child; each; each = each->next) ++count;
  Entry** sorted = take(count + 1, sizeof *sorted);
  for (Entry* each = mapping->child; each; each = each->next) sorted[i++] = each;
  qsort(sorted, count, sizeof *sorted, by_key);
  for (i = 1; i < count; ++i) {
    if (!strcmp(sorted[i - 1]->key, sorted[i]->key)) fail(BAD_INPUT, "%s: twice: %.40s", file, sorted[i]->key);
  }
}
