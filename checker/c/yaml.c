#include <string.h>

#include "base.h"

enum { DEEPEST = 40 };

typedef struct {
  const char *at, *start_of_line, *file;
  int depth;
} Reader;

static void broken(const Reader* in, const char* what) {
  fail(BAD_INPUT, "%s: %s at: %.*s", in->file, what, (int)strcspn(in->at, "\r\n"), in->at);
}

static int column(const Reader* in) { return (int)(in->at - in->start_of_line); }

/* Go to what is read next, over blanks, comments and ends of lines; tell whether it is in another line. */
static bool skip_beside(Reader* in) {
  bool another = false;
  for (;;) {
    in->at += strspn(in->at, " ");
    bool comment = *in->at == '#' && (in->at == in->start_of_line || strchr(" \t", in->at[-1]));
    if (comment) in->at += strcspn(in->at, "\r\n");
    if (*in->at == '\t') broken(in, "a tab");
    if (*in->at == '\r' && in->at[1] == '\n') ++in->at;
    if (*in->at != '\n') return another || !*in->at;
    in->start_of_line = ++in->at;
    another = true;
  }
}

/* Tell whether a colon ends a key here. */
static bool is_colon(const char* at) { return *at == ':' && strchr(" \r\n,]}", at[1]); }

/* A quoted text, with the quote doubled within single quotes, or no escapes within double ones. */
static char* quoted(Reader* in) {
  char quote = *in->at++;
  const char* end = in->at;
  size_t doubled = 0;
  while (*end && *end != '\n' && (*end != quote || (quote == '\'' && end[1] == quote))) {
    if (quote == '"' && *end == '\\') broken(in, "an escape");
    if (*end == quote) ++end, ++doubled;
    ++end;
  }
  if (*end != quote) broken(in, "a quote without end");
  char *text = take((size_t)(end - in->at) + 1, 1), *to = text;
  while (in->at < end) {
    if (*in->at == quote) ++in->at;
    *to++ = *in->at++;
  }
  ++in->at;
  return text;
}

/* A plain text: to the end of its line, a comment, the colon of a key or, within brackets, the end of an item. */
static char* plain(Reader* in, bool in_brackets) {
  const char *from = in->at, *to = from;
  if (strchr("&*!|>%@`?\"'#,[]{}", *from) || (*from == '-' && strchr(" \r\n", from[1]))) broken(in, "what is not read");
  while (*in->at && !strchr("\r\n", *in->at) && !is_colon(in->at) && !(in_brackets && strchr(",[]{}", *in->at))) {
    if (*in->at == '#' && in->at[-1] == ' ') break;
    if (*in->at++ != ' ') to = in->at;
  }
  if (to == from) broken(in, "nothing");
  return copied(from, (size_t)(to - from));
}

static char* text(Reader* in, bool in_brackets) {
  return *in->at == '"' || *in->at == '\'' ? quoted(in) : plain(in, in_brackets);
}

static char* key_of(Reader* in, bool in_brackets) {
  char* key = text(in, in_brackets);
  if (!strcmp(key, "<<")) broken(in, "a merge");
  in->at += strspn(in->at, " ");
  if (!is_colon(in->at)) broken(in, "a key without a colon");
  ++in->at;
  return key;
}

/* Give a list of texts all of them, for lists of numbers. */
static void join_items(Entry* list) {
  size_t size = 1;
  for (const Entry* each = list->child; each; each = each->next) {
    if (each->kind != SCALAR) return;
    size += strlen(each->text) + 1;
  }
  char *text = take(size, 1), *to = text;
  for (const Entry* each = list->child; each; each = each->next) {
    size = strlen(each->text);
    memcpy(to, each->text, size);
    to[size] = each->next ? ' ' : 0;
    to += size + 1;
  }
  list->text = text;
}

static void brackets(Reader* in, Entry* parent, const char* key) {
  bool mapping = *in->at == '{';
  if (!mapping && *in->at != '[') {
    append(parent, key, text(in, true), SCALAR);
    return;
  }
  if (++in->depth > DEEPEST) broken(in, "too deep");
  Entry* entry = append(parent, key, "", mapping ? MAPPING : LIST);
  ++in->at;
  skip_beside(in);
  while (*in->at != (mapping ? '}' : ']')) {
    const char* name = mapping ? key_of(in, true) : NULL;
    skip_beside(in);
    brackets(in, entry, name);
    skip_beside(in);
    if (*in->at == ',') {
      ++in->at;
      skip_beside(in);
    } else if (*in->at != (mapping ? '}' : ']')) {
      broken(in, "a bracket without end");
    }
  }
  ++in->at;
  if (mapping) refuse_equal_keys(entry, in->file);
  if (!mapping) join_items(entry);
  --in->depth;
}

static bool is_item(const Reader* in) { return *in->at == '-' && strchr(" \r\n", in->at[1]); }

/* Tell whether a key, and not a value, begins here. */
static bool is_key(Reader in) {
  if (*in.at == '[' || *in.at == '{') return false;
  text(&in, false);
  in.at += strspn(in.at, " ");
  return is_colon(in.at);
}

static void one_line(Reader* in, Entry* parent, const char* key) {
  if (*in->at == '[' || *in->at == '{') {
    brackets(in, parent, key);
  } else {
    append(parent, key, text(in, false), SCALAR);
  }
  if (!skip_beside(in)) broken(in, "more than a value");
}

static void block(Reader* in, Entry* parent, const char* key);

/* Read what stands behind a key or a dash whose line is indented by `parent_column`. */
static void value(Reader* in, Entry* parent, const char* key, int parent_column, bool of_item) {
  bool below = skip_beside(in);
  bool list = !of_item && column(in) == parent_column && is_item(in);
  if (below && (!*in->at || (column(in) <= parent_column && !list))) {
    append(parent, key, "", SCALAR);
  } else if (below || (of_item && (is_item(in) || is_key(*in)))) {
    block(in, parent, key);
  } else {
    one_line(in, parent, key);
    if (*in->at && column(in) > parent_column) broken(in, "a value in two lines");
  }
}

static void block(Reader* in, Entry* parent, const char* key) {
  int indent = column(in);
  bool list = is_item(in);
  if (!list && !is_key(*in)) {
    one_line(in, parent, key);
    return;
  }
  if (++in->depth > DEEPEST) broken(in, "too deep");
  Entry* entry = append(parent, key, "", list ? LIST : MAPPING);
  while (*in->at && column(in) == indent && is_item(in) == list) {
    const char* name = list ? (++in->at, NULL) : key_of(in, false);
    value(in, entry, name, indent, list);
  }
  if (*in->at && column(in) > indent) broken(in, "an indentation");
  if (!list) refuse_equal_keys(entry, in->file);
  if (list) join_items(entry);
  --in->depth;
}

Entry* parse_yaml(const char* text, size_t length, const char* file) {
  if (strlen(text) != length) fail(BAD_INPUT, "%s: no text", file);
  Reader in = {text, text, file, 0};
  Entry* document = take(1, sizeof *document);
  skip_beside(&in);
  if (!*in.at) fail(BAD_INPUT, "%s: nothing in it", file);
  block(&in, document, NULL);
  if (*in.at) broken(&in, "an indentation");
  return document->child;
}
