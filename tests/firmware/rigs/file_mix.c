#include "tests/firmware/rigs/file_mix.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/scratch.h"

void mix_path_of(char path[MIX_PATH_SIZE], const char *directory, const char *name)
{
    (void)snprintf(path, MIX_PATH_SIZE, "%s/%s", directory, name);
}

void mix_take(const char *directory, struct mix_state *out)
{
    const struct dirent *entry;
    char path[MIX_PATH_SIZE];
    DIR *stream = opendir(directory);
    assert_non_null(stream);
    out->n = 0;
    while ((entry = readdir(stream))) {
        if (entry->d_name[0] != '.') {
            assert_true(out->n < MIX_FILES_MAX);
            struct mix_file *file = &out->files[out->n++];
            assert_true(strlen(entry->d_name) < sizeof file->name);
            memcpy(file->name, entry->d_name, strlen(entry->d_name) + 1);
            mix_path_of(path, directory, file->name);
            file->bytes = scratch_read(path, &file->size);
        }
    }
    (void)closedir(stream);
}

void mix_let_go(struct mix_state *state)
{
    for (size_t i = 0; i < state->n; i++) {
        free(state->files[i].bytes);
    }
    state->n = 0;
}

const struct mix_file *mix_find(const struct mix_state *state, const char *name)
{
    for (size_t i = 0; i < state->n; i++) {
        if (strcmp(state->files[i].name, name) == 0) {
            return &state->files[i];
        }
    }
    return NULL;
}

void mix_put(const char *directory, const struct mix_file *file)
{
    char path[MIX_PATH_SIZE];
    mix_path_of(path, directory, file->name);
    scratch_write(path, file->bytes, file->size);
    assert_int_equal(chmod(path, 0600), 0);
}

static void clear(const char *directory)
{
    struct mix_state state;
    char path[MIX_PATH_SIZE];
    mix_take(directory, &state);
    for (size_t i = 0; i < state.n; i++) {
        mix_path_of(path, directory, state.files[i].name);
        assert_int_equal(unlink(path), 0);
    }
    mix_let_go(&state);
}

void mix_put_back(const char *directory, const struct mix_state *state)
{
    clear(directory);
    for (size_t i = 0; i < state->n; i++) {
        mix_put(directory, &state->files[i]);
    }
}

size_t mix_differing(const struct mix_state *a, const struct mix_state *b,
                     char names[MIX_FILES_MAX][MIX_NAME_SIZE])
{
    const struct mix_state *both[] = {a, b};
    size_t n = 0;
    for (int s = 0; s < 2; s++) {
        for (size_t i = 0; i < both[s]->n; i++) {
            const struct mix_file *one = &both[s]->files[i],
                                  *other = mix_find(both[1 - s], one->name);
            const bool same = other && other->size == one->size &&
                              memcmp(other->bytes, one->bytes, one->size) == 0;
            if (!same && (s == 0 || !other)) {
                assert_true(n < MIX_FILES_MAX);
                memcpy(names[n++], one->name, MIX_NAME_SIZE);
            }
        }
    }
    return n;
}

void mix_states(const struct mix_state *a, const struct mix_state *b,
                char names[MIX_FILES_MAX][MIX_NAME_SIZE], size_t n, unsigned mask,
                struct mix_state *out)
{
    out->n = 0;
    for (size_t i = 0; i < a->n; i++) {
        size_t at = 0;
        while (at < n && strcmp(names[at], a->files[i].name) != 0) {
            at++;
        }
        if (at == n || !(mask & 1u << at)) {
            out->files[out->n++] = a->files[i];
        }
    }
    for (size_t at = 0; at < n; at++) {
        const struct mix_file *file = mix_find(b, names[at]);
        if (file && mask & 1u << at) {
            assert_true(out->n < MIX_FILES_MAX);
            out->files[out->n++] = *file;
        }
    }
}
