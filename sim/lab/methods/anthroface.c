#include "sim/lab/methods/anthroface.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "sim/lab/methods/geodesic.h"
#include "sim/lab/methods/method.h"
#include "sim/lab/methods/subspace.h"

const struct sim_mark sim_marks[SIM_MARKS] = {
    {"eye_out_r", 36},  {"eye_top_r", 37},    {"eye_in_r", 39},     {"eye_bottom_r", 41},
    {"eye_in_l", 42},   {"eye_top_l", 44},    {"eye_out_l", 45},    {"eye_bottom_l", 46},
    {"brow_out_r", 17}, {"brow_in_r", 21},    {"brow_in_l", 22},    {"brow_out_l", 26},
    {"nasion", 27},     {"bridge_upper", 28}, {"bridge_lower", 29}, {"nose_tip", 30},
    {"ala_r", 31},      {"subnasale", 33},    {"ala_l", 35},        {"mouth_r", 48},
    {"lip_upper", 51},  {"mouth_l", 54},      {"lip_lower", 57},    {"stomion", 62},
    {"chin", 8},
};

int sim_mark_find(const char *name)
{
    for (int m = 0; m < SIM_MARKS; m++) {
        if (strcmp(sim_marks[m].name, name) == 0) {
            return m;
        }
    }
    return -1;
}

enum {
    AUTOMATIC = 10,
    POINTS_MAX = SIM_MARKS,
    POINTS_MIN = 8,
    FEATURES_MAX = POINTS_MAX * (POINTS_MAX - 1),
};

/* All of the appliance's landmarks except subnasale and upper lip. */
static const enum iso_landmark automatic[AUTOMATIC] = {
    ISO_LM_NASION,   ISO_LM_NOSE_TIP,  ISO_LM_ALA_R,     ISO_LM_ALA_L,   ISO_LM_EYE_IN_R,
    ISO_LM_EYE_IN_L, ISO_LM_EYE_OUT_R, ISO_LM_EYE_OUT_L, ISO_LM_MOUTH_R, ISO_LM_MOUTH_L,
};

static const double energy = 0.999, shrinkage = 0.1;

struct knowledge {
    bool marked;
    bool marks[SIM_MARKS]; /* marks in use, if marked */
    size_t n_features;
    float *scale; /* [n_features] 1 / standard deviation over the training faces */
    struct sim_subspace *subspace;
};

static void forget_knowledge(void *knowledge)
{
    struct knowledge *k = knowledge;
    if (k) {
        free(k->scale);
        sim_subspace_free(k->subspace);
        free(k);
    }
}

/* Projects the points onto the surface. -ENODATA if one is outside the surface or not marked. */
static int place_points(const struct knowledge *k, const struct sim_scan *face,
                        struct iso_vec3 *points, int *n_points)
{
    int n = 0;
    for (int i = 0; i < (k->marked ? SIM_MARKS : AUTOMATIC); i++) {
        if (k->marked && !k->marks[i]) {
            continue;
        }
        if (k->marked && !face->mark_known[i]) {
            return -ENODATA;
        }
        struct iso_vec3 p = k->marked ? face->mark_mm[i] : face->landmark_mm[automatic[i]];
        if (!sim_scan_height(face, p.x, p.y, &p.z, NULL)) {
            return -ENODATA;
        }
        points[n++] = p;
    }
    *n_points = n;
    return 0;
}

/* Computes the Euclidean, then the geodesic distances of all pairs of points: feature[n * (n - 1)]
 * for n points. */
static int measure_features(const struct knowledge *k, const struct sim_scan *face, float *feature)
{
    struct iso_vec3 points[POINTS_MAX];
    int n_points;
    int error = place_points(k, face, points, &n_points);
    if (error) {
        return error;
    }
    struct sim_geodesic *geodesic = NULL;
    error = sim_geodesic_new(face, &geodesic);
    size_t n = 0, n_pairs = (size_t)(n_points * (n_points - 1) / 2);
    for (int i = 0; !error && i + 1 < n_points; i++) {
        double way_mm[POINTS_MAX];
        const int n_others = n_points - i - 1;
        error = sim_geodesic_from(geodesic, face, points[i], &points[i + 1], n_others, way_mm);
        for (int j = 0; !error && j < n_others; j++, n++) {
            feature[n] = (float)iso_norm(iso_sub(points[i + 1 + j], points[i]));
            feature[n_pairs + n] = (float)way_mm[j];
        }
    }
    sim_geodesic_free(geodesic);
    return error;
}

static void standardise_features(const float *samples, size_t n, struct knowledge *k)
{
    for (size_t i = 0; i < k->n_features; i++) {
        double sum = 0.0, squares = 0.0;
        for (size_t s = 0; s < n; s++) {
            const double x = (double)samples[s * k->n_features + i];
            sum += x;
            squares += x * x;
        }
        const double variance = squares / (double)n - sum * sum / ((double)n * (double)n);
        k->scale[i] = variance > 1e-9 ? (float)(1.0 / sqrt(variance)) : 0.0f;
    }
}

static void rescale_features(const struct knowledge *k, float *feature)
{
    for (size_t i = 0; i < k->n_features; i++) {
        feature[i] *= k->scale[i];
    }
}

/* The training skips faces with points outside the surface. */
static int learn_subspace(const struct sim_training *training, struct knowledge *k)
{
    size_t n = 0;
    float *samples = calloc(training->n * k->n_features, sizeof *samples);
    uint32_t *person = calloc(training->n, sizeof *person);
    k->scale = calloc(k->n_features, sizeof *k->scale);
    int error = samples && person && k->scale ? 0 : -ENOMEM;
    for (size_t i = 0; !error && i < training->n; i++) {
        error = measure_features(k, training->faces[i], &samples[n * k->n_features]);
        person[n] = training->person[i];
        n += error == 0;
        error = error == -ENODATA ? 0 : error;
    }
    if (!error) {
        standardise_features(samples, n, k);
        for (size_t i = 0; i < n; i++) {
            rescale_features(k, &samples[i * k->n_features]);
        }
        error = n > training->n_people
                    ? sim_subspace_discriminant(samples, person, n, k->n_features,
                                                training->n_people, energy, shrinkage, &k->subspace)
                    : -EINVAL;
    }
    free(samples);
    free(person);
    return error;
}

static int train_on(const struct sim_training *training, bool marked, void **knowledge,
                    struct iso_fault *fault)
{
    const char *name = marked ? "anthroface-25" : "anthroface-10";
    struct knowledge *k = calloc(1, sizeof *k);
    if (!k) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    k->marked = marked;
    size_t n_points = AUTOMATIC;
    if (marked) {
        n_points = 0;
        memcpy(k->marks, training->marks, sizeof k->marks);
        for (int m = 0; m < SIM_MARKS; m++) {
            n_points += k->marks[m];
        }
    }
    if (n_points < POINTS_MIN) {
        forget_knowledge(k);
        return iso_fault_set(fault, -EINVAL,
                             "%s: %zu points are marked in all faces, %d are needed", name,
                             n_points, POINTS_MIN);
    }
    k->n_features = n_points * (n_points - 1);
    const int error = learn_subspace(training, k);
    if (error) {
        forget_knowledge(k);
        return iso_fault_set(fault, error, "%s: %zu faces of %u %s: learning failed: %s", name,
                             training->n, (unsigned)training->n_people,
                             iso_plural((uint64_t)training->n_people, "person", "people"),
                             strerror(-error));
    }
    *knowledge = k;
    return 0;
}

static int train_automatic(const struct sim_training *training, void **knowledge,
                           struct iso_fault *fault)
{
    return train_on(training, false, knowledge, fault);
}

static int train_marked(const struct sim_training *training, void **knowledge,
                        struct iso_fault *fault)
{
    return train_on(training, true, knowledge, fault);
}

static int describe_face(const void *knowledge, const struct sim_scan *face, void **description)
{
    const struct knowledge *k = knowledge;
    float feature[FEATURES_MAX] = {0.0f};
    const int error = measure_features(k, face, feature);
    if (error) {
        return error;
    }
    float *coordinate = calloc(k->subspace->n_out, sizeof *coordinate);
    if (!coordinate) {
        return -ENOMEM;
    }
    rescale_features(k, feature);
    sim_subspace_project(k->subspace, feature, coordinate);
    *description = coordinate;
    return 0;
}

static int distance_between(const void *knowledge, const void *probe, const void *gallery,
                            double *out)
{
    const struct knowledge *k = knowledge;
    *out = sim_cosine_distance(probe, gallery, k->subspace->n_out);
    return 0;
}

const struct sim_method sim_method_anthroface_10 = {
    .name = "anthroface-10",
    .source = "Gupta, Markey and Bovik 2010: Euclidean and geodesic distances between 10 points "
              "found automatically, discriminant analysis",
    .train = train_automatic,
    .forget = forget_knowledge,
    .describe = describe_face,
    .discard = free,
    .distance = distance_between,
};

const struct sim_method sim_method_anthroface_25 = {
    .name = "anthroface-25",
    .source = "the same with up to 25 points that are marked in landmarks.csv, as far as all faces "
              "have them",
    .marked = true,
    .train = train_marked,
    .forget = forget_knowledge,
    .describe = describe_face,
    .discard = free,
    .distance = distance_between,
};
