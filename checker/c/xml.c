#include <string.h>

#include "base.h"

enum { DEEPEST = 200, MOST_ATTRIBUTES = 100 };

typedef struct {
  const char *at, *file;
} Reader;

/* Text without its entities, of which XML itself defines five. */
static char* plain(Reader* in, const char* text, size_t size) {
  static const char* const names[] = {"lt;", "gt;", "amp;", "quot;", "apos;"};
  char *copy = copied(text, size), *to = copy;
  for (const char* from = copied(text, size); *from; ++from) {
    *to = *from;
    if (*from == '&') {
      size_t i = 0;
      while (i < 5 && strncmp(from + 1, names[i], strlen(names[i])) != 0) ++i;
      if (i == 5) fail(BAD_INPUT, "%s: an entity that is not read", in->file);
      *to = "<>&\"'"[i];
      from += strlen(names[i]);
    }
    ++to;
  }
  *to = 0;
  return copy;
}

static void skip_blanks(Reader* in) { in->at += strspn(in->at, " \t\r\n"); }

static void skip_past(Reader* in, const char* mark) {
  const char* found = strstr(in->at, mark);
  if (!found) fail(BAD_INPUT, "%s: no %s", in->file, mark);
  in->at = found + strlen(mark);
}

/* Skip blanks, comments and instructions between elements. */
static void skip_beside(Reader* in) {
  for (;;) {
    skip_blanks(in);
    if (!strncmp(in->at, "<!--", 4)) {
      skip_past(in, "-->");
    } else if (!strncmp(in->at, "<?", 2)) {
      skip_past(in, "?>");
    } else {
      return;
    }
  }
}

static char* name(Reader* in) {
  size_t size = strcspn(in->at, " \t\r\n/>=<\"'");
  if (!size || *in->at == '!') fail(BAD_INPUT, "%s: no XML at %.20s", in->file, in->at);
  in->at += size;
  return copied(in->at - size, size);
}

static void attribute(Reader* in, Entry* element) {
  char *word = name(in), *key = take(strlen(word) + 2, 1);
  key[0] = '@';
  strcpy(key + 1, word);
  skip_blanks(in);
  if (*in->at == '=') ++in->at;
  skip_blanks(in);
  char quote = *in->at;
  if (quote != '"' && quote != '\'') fail(BAD_INPUT, "%s: attribute %s has no value", in->file, word);
  if (child_of(element, key)) fail(BAD_INPUT, "%s: attribute %s is given twice", in->file, word);
  const char* end = strchr(in->at + 1, quote);
  if (!end) fail(BAD_INPUT, "%s: attribute %s does not end", in->file, word);
  append(element, key, plain(in, in->at + 1, (size_t)(end - in->at - 1)), SCALAR);
  in->at = end + 1;
}

/* Read an element behind its "<"; the text of an element is what stands before its first child. */
static void element(Reader* in, Entry* parent, int depth) {
  if (depth > DEEPEST) fail(BAD_INPUT, "%s: elements too deep", in->file);
  char *tag = name(in), *colon = strchr(tag, ':');
  Entry* entry = append(parent, colon ? colon + 1 : tag, "", MAPPING);
  int attributes = 0;
  for (skip_blanks(in); *in->at != '>' && *in->at != '/'; skip_blanks(in)) {
    if (++attributes > MOST_ATTRIBUTES) fail(BAD_INPUT, "%s: too many attributes", in->file);
    attribute(in, entry);
  }
  if (*in->at == '/') {
    if (in->at[1] != '>') fail(BAD_INPUT, "%s: <%s> does not end", in->file, tag);
    in->at += 2;
    return;
  }
  ++in->at;
  size_t size = strcspn(in->at, "<");
  entry->text = plain(in, in->at, size);
  bool leaf = true;
  for (in->at += size;; in->at += strcspn(in->at, "<")) {
    skip_beside(in);
    if (!*in->at) fail(BAD_INPUT, "%s: <%s> does not end", in->file, tag);
    if (*in->at != '<' && leaf) fail(BAD_INPUT, "%s: <%s> has a text in parts", in->file, tag);
    if (*in->at != '<') continue;
    ++in->at;
    if (*in->at == '/') break;
    element(in, entry, depth + 1);
    leaf = false;
  }
  ++in->at;
  if (strcmp(name(in), tag) != 0) fail(BAD_INPUT, "%s: <%s> ends with another name", in->file, tag);
  skip_blanks(in);
  if (*in->at++ != '>') fail(BAD_INPUT, "%s: <%s> does not end", in->file, tag);
}

Entry* parse_xml(const char* text, size_t length, const char* file) {
  if (strlen(text) != length) fail(BAD_INPUT, "%s: no text", file);
  Reader in = {text, file};
  if (!strncmp(in.at, "\xef\xbb\xbf", 3)) in.at += 3;
  Entry* document = take(1, sizeof *document);
  skip_beside(&in);
  if (*in.at != '<') fail(BAD_INPUT, "%s: no XML", file);
  ++in.at;
  element(&in, document, 0);
  skip_beside(&in);
  if (*in.at) fail(BAD_INPUT, "%s: more than one element", file);
  return document->child;
}
