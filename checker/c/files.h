/* Files, and the digest of all that were read. */
#ifndef EVENROAD_FILES_H
#define EVENROAD_FILES_H

#include "base.h"

typedef struct {
  const uint8_t* data; /* a 0 byte follows the last one */
  size_t size;
} File;

typedef struct {
  uint32_t state[8];
  uint8_t block[64];
  uint64_t size;
} Sha256;

void sha256_begin(Sha256* hash);
void sha256_add(Sha256* hash, const uint8_t* data, size_t size);
void sha256_end(Sha256* hash, uint8_t digest[32]);

/* A whole file, of at most a gigabyte; its digest joins those in `inputs` unless this is NULL. */
File read_file(const char* path, Sha256* inputs);

/* The folder of a file: all up to its last slash. */
char* folder_of(const char* path);

/* Texts in a row. */
char* joined(const char* first, const char* second, const char* third);

bool exists(const char* path);

#endif
