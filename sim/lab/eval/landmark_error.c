#include "sim/lab/eval/landmark_error.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* A deviation and its person; sorted by person, then session, then original order. */
struct entry {
    const char *subject, *session;
    const struct sim_deviation *deviation;
};

/* Lengths of one kind. The lengths of the current landmark follow those of the previous landmarks.
 */
struct lengths {
    double *mm;
    size_t n, capacity, first;
    bool failed; /* out of memory */
};

enum kind { ERROR, CENTRED, REPEAT, SLIP, KINDS };

struct work {
    const struct entry *entries;
    size_t n_entries;
    struct lengths lengths[KINDS];
};

struct sim_deviation sim_deviation_of(const struct iso_extraction *extraction,
                                      const struct sim_truth *truth, size_t row)
{
    struct iso_mat3 face_from_camera = iso_mat3_transpose(&extraction->camera_from_face.rotation);
    struct sim_deviation deviation = {.row = row};
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (truth->known[l]) {
            struct iso_vec3 e = iso_sub(extraction->landmark_mm[l], truth->point_mm[l]);
            deviation.known[l] = true;
            deviation.error_mm[l] = iso_mat3_apply(&face_from_camera, e);
        }
    }
    return deviation;
}

static double coordinate_of(struct iso_vec3 v, int axis)
{
    const double coordinates[] = {v.x, v.y, v.z};
    return coordinates[axis];
}

int sim_landmark_offsets(const struct sim_deviation *deviations, size_t n,
                         struct iso_vec3 offset_mm[ISO_LANDMARKS])
{
    double *values = calloc(n + 1, sizeof *values);
    if (!values) {
        return -ENOMEM;
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        double median[3];
        for (int axis = 0; axis < 3; axis++) {
            size_t known = 0;
            for (size_t i = 0; i < n; i++) {
                if (deviations[i].known[l]) {
                    values[known++] = coordinate_of(deviations[i].error_mm[l], axis);
                }
            }
            median[axis] = sim_spread_of(values, known).median;
        }
        offset_mm[l] = iso_vec3(median[0], median[1], median[2]);
    }
    free(values);
    return 0;
}

static void add_length(struct lengths *lengths, struct iso_vec3 v)
{
    if (lengths->n == lengths->capacity && !lengths->failed) {
        const size_t capacity = 2 * lengths->capacity + 1024;
        double *larger = realloc(lengths->mm, capacity * sizeof *larger);
        lengths->failed = !larger;
        if (larger) {
            lengths->mm = larger;
            lengths->capacity = capacity;
        }
    }
    if (lengths->n < lengths->capacity) {
        lengths->mm[lengths->n++] = iso_norm(v);
    }
}

/* The number of leading entries that belong to the first entry's person. */
static size_t person_size(const struct entry *e, size_t n)
{
    size_t size = 1;
    while (size < n && strcmp(e[size].subject, e[0].subject) == 0) {
        size++;
    }
    return size;
}

/* The mean over sessions of the mean over a session's frames. Returns the number of sessions in
 * which the landmark is known. */
static size_t person_mean(const struct entry *e, size_t n, int landmark, struct iso_vec3 *mean)
{
    struct iso_vec3 sum = {0, 0, 0};
    size_t sessions = 0;
    for (size_t i = 0; i < n;) {
        struct iso_vec3 session_sum = {0, 0, 0};
        size_t known = 0, first = i;
        for (; i < n && strcmp(e[i].session, e[first].session) == 0; i++) {
            if (e[i].deviation->known[landmark]) {
                session_sum = iso_add(session_sum, e[i].deviation->error_mm[landmark]);
                known++;
            }
        }
        if (known > 0) {
            sum = iso_madd(sum, 1.0 / (double)known, session_sum);
            sessions++;
        }
    }
    *mean = sessions > 0 ? iso_scale(1.0 / (double)sessions, sum) : sum;
    return sessions;
}

static void measure_person(struct work *work, const struct entry *e, size_t n, int landmark)
{
    enum { PAIRS_PER_FRAME = 64 };
    const size_t step = 1 + (n - 1) / PAIRS_PER_FRAME;
    struct iso_vec3 mean;
    const size_t sessions = person_mean(e, n, landmark, &mean);
    for (size_t i = 0; i < n; i++) {
        const struct sim_deviation *a = e[i].deviation;
        if (!a->known[landmark]) {
            continue;
        }
        if (sessions > 1) {
            add_length(&work->lengths[REPEAT], iso_sub(a->error_mm[landmark], mean));
        }
        for (size_t j = i + step; j < n; j += step) {
            const struct sim_deviation *b = e[j].deviation;
            if (b->known[landmark] && a->row != b->row) {
                add_length(&work->lengths[SLIP],
                           iso_sub(a->error_mm[landmark], b->error_mm[landmark]));
            }
        }
    }
}

static void measure_landmark(struct work *work, int landmark, struct iso_vec3 offset_mm)
{
    for (size_t i = 0; i < work->n_entries; i++) {
        const struct sim_deviation *d = work->entries[i].deviation;
        if (d->known[landmark]) {
            add_length(&work->lengths[ERROR], d->error_mm[landmark]);
            add_length(&work->lengths[CENTRED], iso_sub(d->error_mm[landmark], offset_mm));
        }
    }
    for (size_t i = 0; i < work->n_entries;) {
        const size_t n = person_size(&work->entries[i], work->n_entries - i);
        measure_person(work, &work->entries[i], n, landmark);
        i += n;
    }
}

/* The spread of the lengths from `first` on. */
static struct sim_landmark_error summarise_lengths(struct work *work, struct iso_vec3 offset_mm)
{
    struct sim_spread spread[KINDS];
    for (int k = 0; k < KINDS; k++) {
        struct lengths *l = &work->lengths[k];
        spread[k] = sim_spread_of(l->n > l->first ? l->mm + l->first : NULL, l->n - l->first);
        l->first = l->n;
    }
    return (struct sim_landmark_error){offset_mm, spread[ERROR], spread[CENTRED], spread[REPEAT],
                                       spread[SLIP]};
}

static int by_person(const void *a, const void *b)
{
    const struct entry *p = a, *q = b;
    int order = strcmp(p->subject, q->subject);
    order = order ? order : strcmp(p->session, q->session);
    return order ? order : (p->deviation > q->deviation) - (p->deviation < q->deviation);
}

int sim_landmark_errors(const struct sim_corpus *corpus, const struct sim_deviation *deviations,
                        size_t n, const struct iso_vec3 offset_mm[ISO_LANDMARKS],
                        struct sim_landmark_error out[ISO_LANDMARKS + 1])
{
    struct entry *entries = calloc(n + 1, sizeof *entries);
    struct work work = {.entries = entries, .n_entries = n};
    struct sim_landmark_error errors[ISO_LANDMARKS + 1];
    bool failed = !entries;
    for (size_t i = 0; entries && i < n; i++) {
        const struct sim_corpus_row *row = &corpus->rows[deviations[i].row];
        entries[i] = (struct entry){row->subject, row->session, &deviations[i]};
    }
    if (entries) {
        qsort(entries, n, sizeof *entries, by_person);
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            measure_landmark(&work, l, offset_mm[l]);
            errors[l] = summarise_lengths(&work, offset_mm[l]);
        }
    }
    for (int k = 0; k < KINDS; k++) {
        work.lengths[k].first = 0;
        failed = failed || work.lengths[k].failed;
    }
    if (!failed) {
        errors[ISO_LANDMARKS] = summarise_lengths(&work, iso_vec3(0, 0, 0));
        memcpy(out, errors, sizeof errors);
    }
    for (int k = 0; k < KINDS; k++) {
        free(work.lengths[k].mm);
    }
    free(entries);
    return failed ? -ENOMEM : 0;
}

const char *sim_landmark_error_name(int landmark)
{
    return landmark == ISO_LANDMARKS ? "all" : iso_landmark_name((enum iso_landmark)landmark);
}
