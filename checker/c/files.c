#include <errno.h>
#include <stdio.h>
#include <string.h>
#ifdef _WIN32
#include <direct.h>
#define mkdir(path, mode) _mkdir(path)
#else
#include <sys/stat.h>
#endif

#include "base.h"

enum { LARGEST = 1 << 30 };

static uint32_t rotated(uint32_t word, int by) { return word >> by | word << (32 - by); }

/* FIPS 180-4, 6.2.2: one block of 64 bytes. */
static void sha256_block(uint32_t state[8], const uint8_t* block) {
  static const uint32_t constants[64] = {
      0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
      0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
      0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
      0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
      0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
      0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
      0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
      0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
  uint32_t w[64], s[8];
  for (int i = 0; i < 16; ++i) {
    const uint8_t* four = block + 4 * i;
    w[i] = (uint32_t)four[0] << 24 | (uint32_t)four[1] << 16 | (uint32_t)four[2] << 8 | four[3];
  }
  for (int i = 16; i < 64; ++i) {
    uint32_t s0 = rotated(w[i - 15], 7) ^ rotated(w[i - 15], 18) ^ w[i - 15] >> 3;
    uint32_t s1 = rotated(w[i - 2], 17) ^ rotated(w[i - 2], 19) ^ w[i - 2] >> 10;
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  memcpy(s, state, sizeof s);
  for (int i = 0; i < 64; ++i) {
    uint32_t s1 = rotated(s[4], 6) ^ rotated(s[4], 11) ^ rotated(s[4], 25);
    uint32_t first = s[7] + s1 + ((s[4] & s[5]) ^ (~s[4] & s[6])) + constants[i] + w[i];
    uint32_t s0 = rotated(s[0], 2) ^ rotated(s[0], 13) ^ rotated(s[0], 22);
    uint32_t second = s0 + ((s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]));
    memmove(s + 1, s, 7 * sizeof s[0]);
    s[4] += first;
    s[0] = first + second;
  }
  for (int i = 0; i < 8; ++i) state[i] += s[i];
}

void sha256_begin(Sha256* hash) {
  *hash = (Sha256){
      .state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
}

static void sha256_add(Sha256* hash, const uint8_t* data, size_t size) {
  while (size) {
    size_t filled = hash->size % 64, some = 64 - filled < size ? 64 - filled : size;
    memcpy(hash->block + filled, data, some);
    hash->size += some;
    data += some;
    size -= some;
    if (hash->size % 64 == 0) sha256_block(hash->state, hash->block);
  }
}

void sha256_end(Sha256* hash, uint8_t digest[32]) {
  uint64_t bits = 8 * hash->size;
  uint8_t length[8];
  for (int i = 0; i < 8; ++i) length[i] = (uint8_t)(bits >> (56 - 8 * i));
  sha256_add(hash, (const uint8_t*)"\x80", 1);
  while (hash->size % 64 != 56) sha256_add(hash, (const uint8_t*)"", 1);
  sha256_add(hash, length, 8);
  for (int i = 0; i < 32; ++i) digest[i] = (uint8_t)(hash->state[i / 4] >> (24 - 8 * (i % 4)));
}

File read_file(const char* path) {
  FILE* stream = fopen(path, "rb");
  if (!stream) fail(BAD_INPUT, "cannot open %s", path);
  long size = fseek(stream, 0, SEEK_END) ? -1 : ftell(stream);
  bool sized = size >= 0 && size <= LARGEST;
  rewind(stream);
  uint8_t* data = sized ? take((size_t)size + 1, 1) : NULL;
  size_t got = sized ? fread(data, 1, (size_t)size, stream) : 0;
  fclose(stream);
  if (!sized || got != (size_t)size) fail(BAD_INPUT, "no file of at most a gigabyte: %s", path);
  return (File){data, got};
}

static void digest_into(File file, uint8_t digest[32]) {
  Sha256 hash;
  sha256_begin(&hash);
  sha256_add(&hash, file.data, file.size);
  sha256_end(&hash, digest);
}

char* digest_of(File file) {
  uint8_t digest[32];
  char* text = take(65, 1);
  digest_into(file, digest);
  for (int i = 0; i < 32; ++i) snprintf(text + 2 * i, 3, "%02x", digest[i]);
  return text;
}

File next_file(Files* files, const char* path) {
  File file;
  uint8_t digest[32];
  if (files->own) {
    if (!files->left) fail(REFUSED, "it does not carry %.200s", path);
    size_t size = (size_t)little_endian(files->carried, 8); /* which fits, as read_certificate has seen to */
    file = (File){(uint8_t*)copied((const char*)files->carried + 8, size), size};
    files->taken[files->taken_count++] = (Carried){path + strlen(folder_of(path)), file};
    files->carried += 8 + size;
    files->left -= 8 + size;
  } else {
    file = read_file(path);
  }
  digest_into(file, digest);
  sha256_add(&files->hash, digest, sizeof digest);
  return file;
}

char* folder_of(const char* path) {
  const char* slash = strrchr(path, '/');
  return copied(path, slash ? (size_t)(slash - path) + 1 : 0);
}

static void write_file(const char* path, File file) {
  const char* part = joined(path, ".part", "");
  FILE* stream = fopen(part, "wb");
  bool whole = stream && fwrite(file.data, 1, file.size, stream) == file.size;
  if (stream) whole = !fclose(stream) && whole;
  if (!whole) fail(BAD_INPUT, "cannot write %s", path);
  remove(path); /* not all systems replace a file by another name */
  if (rename(part, path)) fail(BAD_INPUT, "cannot write %s", path);
}

void write_files(const char* folder, const Carried* files, size_t count) {
  const char** names = take(count + 1, sizeof *names);
  if (mkdir(folder, 0777) && errno != EEXIST) fail(BAD_INPUT, "cannot make the folder %s", folder);
  for (size_t i = 0; i < count; ++i) {
    size_t same = 0, number = 1;
    const char* name = files[i].name;
    for (; same < i; ++same) {
      if (strcmp(names[same], name) != 0) continue;
      File a = files[i].file, b = files[same].file;
      if (a.size == b.size && !memcmp(a.data, b.data, a.size)) break;
      char before[32];
      snprintf(before, sizeof before, "%zu-", ++number);
      name = joined(before, files[i].name, "");
      same = NONE; /* look for the new name from the beginning */
    }
    names[i] = name;
    if (same == i) write_file(joined(folder, "/", name), files[i].file);
  }
}

bool exists(const char* path) {
  FILE* stream = fopen(path, "rb");
  if (stream) fclose(stream);
  return stream != NULL;
}
