/* evenroad-verify in C: checks that a certificate proves a robot's path free of collision, as docs/certificates.md
 * says. */
#include <stdio.h>
#include <string.h>

#include "verify.h"

static const char USAGE[] =
    "usage: evenroad-verify [--package NAME=FOLDER] [--path PATH] certificate robot scene [srdf]\n"
    "Check that a path is proved free of contact: 0 if it is, 1 if the certificate is refused, 2 for bad input.\n";

enum { MOST_PACKAGES = 64 };

/* What is asked for; set before anything can fail. */
typedef struct {
  const char *files[4], *path, *packages[MOST_PACKAGES];
  Places places;
} Asked;

/* Read the command line; false if it is none. */
static bool understood(int count, char** words, Asked* asked) {
  int files = 0;
  for (int i = 1; i < count; ++i) {
    bool package = !strcmp(words[i], "--package"), path = !strcmp(words[i], "--path");
    if (package || path) {
      if (++i == count) return false;
      if (path) asked->path = words[i];
      if (package && asked->places.package_count == MOST_PACKAGES) return false;
      if (package) asked->packages[asked->places.package_count++] = words[i];
    } else if (files == 4 || words[i][0] == '-') {
      return false;
    } else {
      asked->files[files++] = words[i];
    }
  }
  asked->places.packages = asked->packages;
  return files >= 3;
}

int main(int count, char** words) {
  static Asked asked;
  if (!understood(count, words, &asked)) {
    fputs(USAGE, stderr);
    return BAD_INPUT;
  }
  int code = setjmp(on_failure);
  if (code == REFUSED) printf("REFUSED: %s\n", failure);
  if (code == BAD_INPUT) fprintf(stderr, "evenroad-verify: %s\n", failure);
  if (!code) {
    File certificate = read_file(asked.files[0], NULL);
    Proved proved = verify(read_inputs(asked.files[1], asked.files[2], asked.files[3], asked.places), certificate);
    if (asked.path) require_same_path(proved.model->certificate, asked.path);
    print_proved(&proved);
  }
  release(NULL);
  return code;
}
