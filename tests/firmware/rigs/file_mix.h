/* The files of a flat directory at one time, and mixtures of two such states. A failure fails the
 * test. */
#ifndef TESTS_FIRMWARE_RIGS_FILE_MIX_H
#define TESTS_FIRMWARE_RIGS_FILE_MIX_H

#include <stddef.h>

enum { MIX_FILES_MAX = 20, MIX_NAME_SIZE = 64, MIX_PATH_SIZE = 512 };

struct mix_file {
    char name[MIX_NAME_SIZE];
    void *bytes;
    size_t size;
};

struct mix_state {
    size_t n;
    struct mix_file files[MIX_FILES_MAX];
};

void mix_path_of(char path[MIX_PATH_SIZE], const char *directory, const char *name);

/* Reads every file of a directory. mix_let_go frees them. */
void mix_take(const char *directory, struct mix_state *out);
void mix_let_go(struct mix_state *state);

/* Returns NULL if no file has this name. */
const struct mix_file *mix_find(const struct mix_state *state, const char *name);

/* mix_put writes one file. mix_put_back writes all files of the state and removes all others. */
void mix_put(const char *directory, const struct mix_file *file);
void mix_put_back(const char *directory, const struct mix_state *state);

/* Writes the names of the files that differ between the two states. Returns how many they are. */
size_t mix_differing(const struct mix_state *a, const struct mix_state *b,
                     char names[MIX_FILES_MAX][MIX_NAME_SIZE]);

/* Mixes two states: the files that the mask selects come from `b`, all others from `a`. A selected
 * file that `b` lacks is left out. `out` uses the memory of `a` and `b`. */
void mix_states(const struct mix_state *a, const struct mix_state *b,
                char names[MIX_FILES_MAX][MIX_NAME_SIZE], size_t n, unsigned mask,
                struct mix_state *out);

#endif
