/* XML and YAML as one kind of tree, by readers of the subsets that robots and scenes need. */
#ifndef EVENROAD_TREE_H
#define EVENROAD_TREE_H

#include "base.h"

enum { MAPPING = 1, LIST, SCALAR };

/* An element of XML, without the prefix of its name (attributes are children as "@name"), or a value of YAML; items of
 * a list have no key. */
typedef struct Entry {
  const char *key, *text;
  int kind;
  struct Entry *child, *last, *next;
} Entry;

Entry* parse_xml(const char* text, size_t length, const char* file);
Entry* parse_yaml(const char* text, size_t length, const char* file);

/* The first child of this key, or NULL. */
Entry* child_of(const Entry* entry, const char* key);

/* The same, where a second one is bad input. */
Entry* only_child_of(const Entry* entry, const char* key);

/* The text of a child, or `otherwise`. */
const char* text_of(const Entry* entry, const char* key, const char* otherwise);

/* Append a new entry to its parent. */
Entry* append(Entry* parent, const char* key, const char* text, int kind);

#endif
