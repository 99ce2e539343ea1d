#include "firmware/site/site_batch.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/match/metric_vector.h"

/* A template that waits. */
struct kept {
    int64_t person, number;
    bool learned;
    char sensor[ISO_TEMPLATE_SENSOR_MAX];
};

struct iso_site_batch {
    struct iso_site_index *site;
    uint32_t algorithm;
    const struct iso_metric *metric;
    struct iso_metric_steps steps;
    struct iso_template tmpl;  /* the one that is being added */
    float *residual_mm;        /* [ISO_METRIC_ROWS][metric->n_values] */
    iso_site_batch_made *made; /* NULL: nobody wants to know */
    void *made_context;
    bool learned; /* a template that was added */
    int n;        /* templates that wait */
    struct kept kept[ISO_METRIC_ROWS];
    struct iso_metric_vector vector[ISO_METRIC_ROWS];
};

int iso_site_batch_new(struct iso_site_index *site, uint32_t algorithm,
                       const struct iso_metric *metric, struct iso_site_batch **out)
{
    struct iso_site_batch *b = calloc(1, sizeof *b);
    if (b) {
        b->site = site;
        b->algorithm = algorithm;
        b->metric = metric;
        b->residual_mm = calloc(ISO_METRIC_ROWS * (size_t)metric->n_values, sizeof(float));
    }
    if (!b || !b->residual_mm) {
        iso_site_batch_free(b);
        return -ENOMEM;
    }
    iso_metric_steps_fill(metric, &b->steps);
    *out = b;
    return 0;
}

void iso_site_batch_free(struct iso_site_batch *batch)
{
    if (batch) {
        iso_wipe_free(batch->residual_mm);
        iso_wipe_free(batch);
    }
}

int iso_site_batch_end(struct iso_site_batch *batch)
{
    const int n = batch->n;
    if (n == 0) {
        return 0;
    }
    int error = iso_site_index_reserve(batch->site, (size_t)n);
    batch->n = 0;
    if (!error) {
        iso_metric_project_rows(batch->metric, &batch->steps, batch->residual_mm, n, batch->vector);
    }
    for (int i = 0; i < n && !error; i++) {
        const struct kept *kept = &batch->kept[i];
        error = iso_site_index_add(batch->site, kept->person, (uint64_t)kept->number, kept->sensor,
                                   &batch->vector[i]);
        if (!error && batch->made) {
            batch->made(batch->made_context, kept->number, kept->learned, kept->sensor,
                        &batch->vector[i]);
        }
    }
    return error;
}

bool iso_site_batch_learned(const struct iso_site_batch *batch)
{
    return batch->learned;
}

void iso_site_batch_tell(struct iso_site_batch *batch, iso_site_batch_made *made, void *context)
{
    batch->made = made;
    batch->made_context = context;
}

/* What waits comes first, because the mean of a person's vectors depends on their order. */
int iso_site_batch_add_vector(struct iso_site_batch *batch, int64_t person, int64_t number,
                              const char *sensor, const struct iso_metric_vector *vector)
{
    int error = iso_site_batch_end(batch);
    if (!error) {
        error = iso_site_index_reserve(batch->site, 1);
    }
    return error ? error
                 : iso_site_index_add(batch->site, person, (uint64_t)number, sensor, vector);
}

/* Keeps the residuals of batch->tmpl. */
static int keep_residuals(struct iso_site_batch *batch, int64_t person, int64_t number)
{
    float *row = &batch->residual_mm[(size_t)batch->n * (size_t)batch->metric->n_values];
    if (batch->tmpl.algorithm != batch->algorithm) {
        return -EINVAL;
    }
    const int error = iso_metric_residuals(batch->metric, &batch->tmpl, row);
    if (error) {
        return error == -ENODATA ? 0 : error;
    }
    struct kept *kept = &batch->kept[batch->n++];
    *kept = (struct kept){.person = person, .number = number, .learned = batch->tmpl.learned};
    memcpy(kept->sensor, batch->tmpl.sensor, sizeof kept->sensor);
    return 0;
}

int iso_site_batch_add(struct iso_site_batch *batch, int64_t person, int64_t number,
                       const void *bytes, size_t size)
{
    int error = iso_template_parse(bytes, size, &batch->tmpl);
    if (!error) {
        batch->learned = batch->learned || batch->tmpl.learned;
        error = keep_residuals(batch, person, number);
    }
    return !error && batch->n == ISO_METRIC_ROWS ? iso_site_batch_end(batch) : error;
}
