#include "core/match/cohort.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/base/fault.h"
#include "core/match/template_points.h"

struct iso_cohort {
    int n;
    struct iso_template templates[];
};

static const char magic[8] = {'I', 'S', 'O', 'C', 'O', 'H', 'O', '1'};

enum { HEADER_BYTES = 8 + 4 + 4, COUNT_BYTES = 4 };

/* The templates that follow the header. */
static int parse_templates(const uint8_t *p, size_t size, struct iso_cohort *cohort,
                           struct iso_fault *fault)
{
    for (int i = 0; i < cohort->n; i++) {
        if (size < 4 || iso_get_u32(p) > size - 4) {
            return iso_fault_set(fault, -EBADMSG, "cohort file: template cut off");
        }
        const size_t bytes = iso_get_u32(p);
        if (iso_template_parse(p + 4, bytes, &cohort->templates[i]) ||
            !iso_template_comparable(&cohort->templates[i], &cohort->templates[0])) {
            return iso_fault_set(fault, -EBADMSG, "cohort file: bad template");
        }
        p += 4 + bytes;
        size -= 4 + bytes;
    }
    return size == 0 ? 0
                     : iso_fault_set(fault, -EBADMSG, "cohort file: bytes after the last template");
}

int iso_cohort_parse(const void *bytes, size_t size, struct iso_cohort **out,
                     struct iso_fault *fault)
{
    const uint8_t *p = bytes;
    if (size < HEADER_BYTES + COUNT_BYTES || memcmp(p, magic, sizeof magic) != 0) {
        return iso_fault_set(fault, -EBADMSG, "not a cohort file of version 1");
    }
    if (iso_get_u32(p + 8) != size) {
        return iso_fault_set(fault, -EBADMSG, "cohort file: truncated or too long");
    }
    if (iso_get_u32(p + 12) != iso_crc32(0, p + HEADER_BYTES, size - HEADER_BYTES)) {
        return iso_fault_set(fault, -EBADMSG, "cohort file: checksum is wrong");
    }
    const uint32_t count = iso_get_u32(p + HEADER_BYTES);
    if (count < ISO_COHORT_MIN || count > ISO_COHORT_MAX) {
        return iso_fault_set(fault, -EBADMSG, "cohort file: number of templates out of range");
    }
    struct iso_cohort *cohort = calloc(1, sizeof *cohort + count * sizeof cohort->templates[0]);
    if (!cohort) {
        return iso_fault_set(fault, -ENOMEM, "cohort file: out of memory");
    }
    cohort->n = (int)count;
    const int error = parse_templates(p + HEADER_BYTES + COUNT_BYTES,
                                      size - HEADER_BYTES - COUNT_BYTES, cohort, fault);
    if (error) {
        iso_cohort_free(cohort);
        return error;
    }
    *out = cohort;
    return 0;
}

int iso_cohort_serialise(const struct iso_template *const *templates, int n, void **bytes,
                         size_t *size)
{
    if (n < ISO_COHORT_MIN || n > ISO_COHORT_MAX) {
        return -EINVAL;
    }
    const size_t capacity = HEADER_BYTES + COUNT_BYTES + (size_t)n * (4 + ISO_TEMPLATE_BYTES_MAX);
    uint8_t *buffer = malloc(capacity);
    if (!buffer) {
        return -ENOMEM;
    }
    uint8_t *p = iso_put_u32(buffer + HEADER_BYTES, (uint32_t)n);
    for (int i = 0; i < n; i++) {
        const int written = iso_template_serialise(templates[i], p + 4, ISO_TEMPLATE_BYTES_MAX);
        if (written < 0 || !iso_template_comparable(templates[i], templates[0])) {
            free(buffer);
            return -EINVAL;
        }
        p = iso_put_u32(p, (uint32_t)written) + written;
    }
    const size_t total = (size_t)(p - buffer);
    p = iso_put_bytes(buffer, magic, sizeof magic);
    p = iso_put_u32(p, (uint32_t)total);
    (void)iso_put_u32(p, iso_crc32(0, buffer + HEADER_BYTES, total - HEADER_BYTES));
    *bytes = buffer;
    *size = total;
    return 0;
}

void iso_cohort_free(struct iso_cohort *cohort)
{
    free(cohort);
}

int iso_cohort_size(const struct iso_cohort *cohort)
{
    return cohort->n;
}

uint32_t iso_cohort_algorithm(const struct iso_cohort *cohort)
{
    return cohort->templates[0].algorithm;
}

int iso_cohort_normalise(struct iso_icp_workspace *work, const struct iso_cohort *cohort,
                         const struct iso_template *probe, const struct iso_match_options *options,
                         struct iso_cohort_norm *out)
{
    double sum = 0.0;
    for (int i = 0; i < cohort->n; i++) {
        double distance;
        const int error = iso_match_distance(work, probe, &cohort->templates[i], options,
                                             &distance);
        if (error) {
            return error;
        }
        sum += distance;
    }
    out->mean_mm = sum / cohort->n;
    return 0;
}

double iso_cohort_score(struct iso_cohort_norm norm, double distance_mm)
{
    const double typical_mm = 2.0;
    /* The lower limit keeps the score finite if the probe equals all templates of the cohort. */
    return 1.0 - distance_mm / sqrt(fmax(norm.mean_mm, 1e-3) * typical_mm);
}
