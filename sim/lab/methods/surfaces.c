/* Eigensurfaces and fishersurfaces: range images of the face, pixel by pixel, in a linear subspace.
 *
 * Eigensurfaces: Chang, Bowyer and Flynn 2003 and 2005 (principal components of registered range
 * images, Mahalanobis cosine). Fishersurfaces: BenAbdelkader and Griffin 2005, Heseltine, Pears and
 * Austin 2004 (linear discriminant analysis of them). Here the images are the face patch, so that
 * registration, hole filling and smoothing are the appliance's; pixels that are not of the face are
 * left out; both compare by the cosine in coordinates of unit variance. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "sim/lab/methods/method.h"
#include "sim/lab/methods/subspace.h"

static const double energy = 0.99, shrinkage = 0.1;

struct knowledge {
    size_t n_pixels; /* of the face's grid */
    uint32_t *pixel; /* [subspace->n_in] the pixels in use */
    struct sim_subspace *subspace;
};

static void forget(void *knowledge)
{
    struct knowledge *k = knowledge;
    if (k) {
        free(k->pixel);
        sim_subspace_free(k->subspace);
        free(k);
    }
}

static void read_pixels(const struct sim_scan *face, const uint32_t *pixel, size_t n, float *out)
{
    for (size_t i = 0; i < n; i++) {
        out[i] = face->z_mm[pixel[i]];
    }
}

/* Lists the pixels at which every face has a surface, and returns their number. */
static size_t choose_pixels(const struct sim_training *training, uint32_t *pixel)
{
    size_t n = 0;
    for (size_t i = 0; i < sim_scan_pixels(training->faces[0]); i++) {
        bool everywhere = true;
        for (size_t k = 0; k < training->n && everywhere; k++) {
            everywhere = !isnan(training->faces[k]->z_mm[i]);
        }
        pixel[n] = (uint32_t)i;
        n += everywhere;
    }
    return n;
}

static int learn(const struct sim_training *training, bool fisher, struct knowledge *k)
{
    const size_t n = training->n;
    k->n_pixels = sim_scan_pixels(training->faces[0]);
    k->pixel = calloc(k->n_pixels, sizeof *k->pixel);
    if (!k->pixel) {
        return -ENOMEM;
    }
    const size_t n_in = choose_pixels(training, k->pixel);
    float *samples = calloc(n * n_in + 1, sizeof *samples);
    if (!samples) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        read_pixels(training->faces[i], k->pixel, n_in, &samples[i * n_in]);
    }
    const int error = fisher ? sim_subspace_discriminant(samples, training->person, n, n_in,
                                                         training->n_people, energy, shrinkage,
                                                         &k->subspace)
                             : sim_subspace_principal(samples, n, n_in, energy, n, &k->subspace);
    free(samples);
    return error;
}

static int train(const struct sim_training *training, bool fisher, void **knowledge,
                 struct iso_fault *fault)
{
    struct knowledge *k = calloc(1, sizeof *k);
    int error = k ? 0 : -ENOMEM;
    if (k) {
        error = training->n < 2 ? -EINVAL : learn(training, fisher, k);
    }
    if (error) {
        forget(k);
        return iso_fault_set(
            fault, error, "%s: %zu faces of %u %s: learning failed: %s",
            fisher ? "fishersurfaces" : "eigensurfaces", training->n, (unsigned)training->n_people,
            iso_plural((uint64_t)training->n_people, "person", "people"), strerror(-error));
    }
    *knowledge = k;
    return 0;
}

static int train_principal(const struct sim_training *training, void **knowledge,
                           struct iso_fault *fault)
{
    return train(training, false, knowledge, fault);
}

static int train_discriminant(const struct sim_training *training, void **knowledge,
                              struct iso_fault *fault)
{
    return train(training, true, knowledge, fault);
}

static int describe(const void *knowledge, const struct sim_scan *face, void **description)
{
    const struct knowledge *k = knowledge;
    const size_t n_in = k->subspace->n_in;
    if (sim_scan_pixels(face) != k->n_pixels) {
        return -ENODATA;
    }
    float *pixels = calloc(n_in, sizeof *pixels);
    float *coordinate = calloc(k->subspace->n_out, sizeof *coordinate);
    if (!pixels || !coordinate) {
        free(pixels);
        free(coordinate);
        return -ENOMEM;
    }
    read_pixels(face, k->pixel, n_in, pixels);
    sim_subspace_project(k->subspace, pixels, coordinate);
    explicit_bzero(pixels, n_in * sizeof *pixels);
    free(pixels);
    *description = coordinate;
    return 0;
}

static int distance(const void *knowledge, const void *probe, const void *gallery, double *out)
{
    const struct knowledge *k = knowledge;
    *out = sim_cosine_distance(probe, gallery, k->subspace->n_out);
    return 0;
}

const struct sim_method sim_method_eigensurfaces = {
    .name = "eigensurfaces",
    .source = "Chang, Bowyer and Flynn 2005: principal components of range images, Mahalanobis "
              "cosine",
    .train = train_principal,
    .forget = forget,
    .describe = describe,
    .discard = free,
    .distance = distance,
};

const struct sim_method sim_method_fishersurfaces = {
    .name = "fishersurfaces",
    .source = "BenAbdelkader and Griffin 2005; Heseltine, Pears and Austin 2004: discriminant "
              "analysis of range images, cosine",
    .train = train_discriminant,
    .forget = forget,
    .describe = describe,
    .discard = free,
    .distance = distance,
};
