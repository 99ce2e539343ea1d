#include "sim/door/level_report.h"

#include <stdbool.h>
#include <string.h>

#include "sim/base/result_file.h"
#include "sim/lab/measure/rate.h"

static bool is_stranger(const struct sim_visit *visit)
{
    return visit->row->role != SIM_ROLE_PROBE;
}

/* Whether a visit is the first one of its subject in its role. */
static bool is_new(const struct sim_visit *visits, size_t visit)
{
    for (size_t i = 0; i < visit; i++) {
        if (is_stranger(&visits[i]) == is_stranger(&visits[visit]) &&
            strcmp(visits[i].row->subject, visits[visit].row->subject) == 0) {
            return false;
        }
    }
    return true;
}

/* Counts the visits of the subject whose first visit is visits[0]. */
static struct sim_rate count_person(const struct sim_visit *visits, size_t n_visits)
{
    const struct sim_visit *first = &visits[0];
    struct sim_rate rate = {0, 0};
    for (size_t i = 0; i < n_visits; i++) {
        if (is_stranger(&visits[i]) != is_stranger(first) ||
            strcmp(visits[i].row->subject, first->row->subject) != 0) {
            continue;
        }
        const struct sim_visit_summary one = sim_visit_judge(&visits[i], 1);
        rate.events += is_stranger(first) ? one.impostors_let_in : one.probes - one.probes_admitted;
        rate.trials++;
    }
    return rate;
}

void sim_level_count(enum sim_level_crowd crowd, const struct sim_visit *visits, size_t n_visits,
                     struct sim_level_counts *counts)
{
    struct iso_people_rate *strangers = crowd == SIM_CROWD_PEOPLE ? &counts->strangers
                                                                  : &counts->alike;
    for (size_t i = 0; i < n_visits; i++) {
        if (!is_new(visits, i) || (crowd == SIM_CROWD_ALIKE && !is_stranger(&visits[i]))) {
            continue;
        }
        const struct sim_rate person = count_person(&visits[i], n_visits - i);
        iso_people_rate_add(is_stranger(&visits[i]) ? strangers : &counts->refused, person.events,
                            person.trials);
    }
}

static void print_rate(const struct iso_people_rate *of, FILE *out)
{
    const struct iso_interval interval = iso_people_rate_interval(of);
    if (of->trials == 0) {
        fputs(" not measured |", out);
        return;
    }
    fprintf(out, " %.1f %% [%.2f, %.2f] (%zu of %zu) |", 100.0 * iso_people_rate_value(of),
            100.0 * interval.low, 100.0 * interval.high, of->errors, of->trials);
}

void sim_level_print_head(FILE *out)
{
    fputs("| `level` | enrolled people refused | strangers let in | look-alikes let in |\n"
          "| --- | --- | --- | --- |\n",
          out);
}

void sim_level_print(const struct sim_level_counts counts[SIM_LEVELS], const char *setting,
                     FILE *out)
{
    for (int level = 0; level < SIM_LEVELS; level++) {
        fprintf(out, "| `%s`%s |", sim_level_name((enum iso_level)level), setting);
        print_rate(&counts[level].refused, out);
        print_rate(&counts[level].strangers, out);
        print_rate(&counts[level].alike, out);
        fputc('\n', out);
    }
}

static void write_row(enum iso_level level, const char *who, const struct iso_people_rate *rate,
                      FILE *out)
{
    const struct iso_interval interval = iso_people_rate_interval(rate);
    fprintf(out, "%s,%s,%zu,%zu,%.6f,%.6f,%.6f,%zu\n", sim_level_name(level), who, rate->errors,
            rate->trials, rate->trials > 0 ? iso_people_rate_value(rate) : 0.0, interval.low,
            interval.high, rate->people);
}

static void write_levels(const void *context, FILE *out)
{
    const struct sim_level_counts *counts = context;
    fputs("level,who,errors,visits,rate,low,high,people\n", out);
    for (int level = 0; level < SIM_LEVELS; level++) {
        write_row((enum iso_level)level, "refused", &counts[level].refused, out);
        write_row((enum iso_level)level, "strangers", &counts[level].strangers, out);
        write_row((enum iso_level)level, "alike", &counts[level].alike, out);
    }
}

int sim_level_write_csv(const char *directory, const char *name,
                        const struct sim_level_counts counts[SIM_LEVELS], struct iso_fault *fault)
{
    return sim_result_file(directory, name, write_levels, counts, fault);
}
