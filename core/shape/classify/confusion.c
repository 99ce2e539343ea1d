#include "core/shape/classify/confusion.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static int32_t predicted_class(const double *score, int32_t n_classes)
{
    int32_t best = 0;
    for (int32_t c = 1; c < n_classes; c++) {
        best = score[c] > score[best] ? c : best;
    }
    return best;
}

/* The chance that the score of a member is above that of a non-member. */
static double roc_area(const double *score, const int32_t *label, int32_t n, int32_t n_classes,
                       int32_t class)
{
    double above = 0.0, pairs = 0.0;
    for (int32_t i = 0; i < n; i++) {
        for (int32_t j = 0; label[i] == class && j < n; j++) {
            if (label[j] != class) {
                const double a = score[(size_t)i * (size_t)n_classes + (size_t) class];
                const double b = score[(size_t)j * (size_t)n_classes + (size_t) class];
                above += 0.5 * ((a > b) + (a >= b)); /* half for a tie */
                pairs += 1.0;
            }
        }
    }
    return pairs > 0.0 ? above / pairs : 0.0;
}

/* Rates of one class from the matrix; all but the area. */
static struct iso_confusion_rates rates_of(const int32_t *count, int32_t n_classes, int32_t class)
{
    double hit = 0.0, predicted = 0.0, members = 0.0, all = 0.0;
    for (int32_t i = 0; i < n_classes; i++) {
        for (int32_t j = 0; j < n_classes; j++) {
            const double n = count[(size_t)i * (size_t)n_classes + (size_t)j];
            all += n;
            members += i == class ? n : 0.0;
            predicted += j == class ? n : 0.0;
            hit += i == class && j == class ? n : 0.0;
        }
    }
    struct iso_confusion_rates r = {0};
    r.tp_rate = r.recall = members > 0.0 ? hit / members : 0.0;
    r.fp_rate = all > members ? (predicted - hit) / (all - members) : 0.0;
    r.precision = predicted > 0.0 ? hit / predicted : 0.0;
    return r;
}

static bool is_valid(const double *score, const int32_t *label, int32_t n, int32_t n_classes)
{
    if (n < 1 || n_classes < 1) {
        return false;
    }
    for (int32_t i = 0; i < n; i++) {
        if (label[i] < 0 || label[i] >= n_classes) {
            return false;
        }
        for (int32_t c = 0; c < n_classes; c++) {
            if (isnan(score[(size_t)i * (size_t)n_classes + (size_t)c])) {
                return false;
            }
        }
    }
    return true;
}

int iso_confusion_measure(const double *score, const int32_t *label, int32_t n, int32_t n_classes,
                          int32_t *count, struct iso_confusion_rates *rates,
                          struct iso_confusion_rates *mean)
{
    if (!is_valid(score, label, n, n_classes)) {
        return -EINVAL;
    }
    const size_t cells = (size_t)n_classes * (size_t)n_classes;
    int32_t *matrix = calloc(cells, sizeof *matrix);
    if (!matrix) {
        return -ENOMEM;
    }
    for (int32_t i = 0; i < n; i++) {
        const int32_t predicted = predicted_class(&score[(size_t)i * (size_t)n_classes], n_classes);
        matrix[(size_t)label[i] * (size_t)n_classes + (size_t)predicted]++;
    }
    struct iso_confusion_rates sum = {0};
    double weights = 0.0;
    for (int32_t c = 0; c < n_classes; c++) {
        struct iso_confusion_rates r = rates_of(matrix, n_classes, c);
        int32_t members = 0;
        for (int32_t i = 0; i < n; i++) {
            members += label[i] == c;
        }
        r.roc_area = roc_area(score, label, n, n_classes, c);
        const double weight = members < n ? members : 0.0;
        weights += weight;
        sum.tp_rate += weight * r.tp_rate;
        sum.fp_rate += weight * r.fp_rate;
        sum.precision += weight * r.precision;
        sum.recall += weight * r.recall;
        sum.roc_area += weight * r.roc_area;
        if (rates) {
            rates[c] = r;
        }
    }
    if (count) {
        memcpy(count, matrix, cells * sizeof *count);
    }
    free(matrix);
    weights = weights > 0.0 ? weights : 1.0;
    *mean = (struct iso_confusion_rates){sum.tp_rate / weights, sum.fp_rate / weights,
                                         sum.precision / weights, sum.recall / weights,
                                         sum.roc_area / weights};
    return 0;
}
