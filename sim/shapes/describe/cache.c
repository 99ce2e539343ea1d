#include "sim/shapes/describe/cache.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "drivers/base/path.h"
#include "drivers/file/file.h"

enum { KEY_BYTES = 20 };

static const size_t bytes_most = (size_t)1 << 30;

static int add_file(crypto_generichash_state *state, const char *path, struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size = 0;
    const int error = iso_file_read(path, bytes_most, &bytes, &size, fault);
    if (!error) {
        (void)crypto_generichash_update(state, (const unsigned char *)bytes, size);
    }
    free(bytes);
    return error;
}

int sim_cache_hash(const char *path, uint8_t content[32], struct iso_fault *fault)
{
    crypto_generichash_state state;
    char beside[PATH_MAX];
    (void)crypto_generichash_init(&state, NULL, 0, 32);
    int error = add_file(&state, path, fault);
    const size_t length = strlen(path);
    if (!error && length > 5 && length < sizeof beside &&
        strcasecmp(path + length - 5, ".vert") == 0) {
        (void)snprintf(beside, sizeof beside, "%.*stri", (int)length - 4, path);
        error = add_file(&state, beside, fault);
    }
    if (!error) {
        (void)crypto_generichash_final(&state, content, 32);
    }
    return error;
}

void sim_cache_name(const struct sim_cache_subject *subject, const struct iso_shape_method *method,
                    char name[SIM_CACHE_NAME_SIZE])
{
    const struct sim_source_options *source = subject->source;
    const struct sim_distortion *distortion = source->distortion;
    char text[512], hex[2 * KEY_BYTES + 1];
    unsigned char key[KEY_BYTES];
    const int n = snprintf(
        text, sizeof text, "%d %s %s %d %d %d %d %d %d %.17g %.17g %d %d %llu %s",
        (int)SIM_CACHE_REVISION, ISOTHERM_VERSION, method->name, source->vertices, source->smooth,
        source->neighbours, subject->n_pairs, subject->colours, subject->times.n,
        subject->times.first, subject->times.last, distortion ? (int)distortion->kind : -1,
        distortion ? distortion->level : 0, distortion ? (unsigned long long)source->seed : 0,
        distortion ? subject->name : "");
    crypto_generichash_state state;
    (void)crypto_generichash_init(&state, NULL, 0, sizeof key);
    (void)crypto_generichash_update(&state, subject->content, sizeof subject->content);
    (void)crypto_generichash_update(&state, (const unsigned char *)text,
                                    (unsigned long long)(n > 0 ? strlen(text) : 0));
    (void)crypto_generichash_final(&state, key, sizeof key);
    (void)sodium_bin2hex(hex, sizeof hex, key, sizeof key);
    (void)snprintf(name, SIM_CACHE_NAME_SIZE, "%s.description", hex);
}
