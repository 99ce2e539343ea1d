#include "sim/door/level_report.h"

#include "sim/base/result_file.h"

static void add(struct sim_rate *rate, size_t events, size_t trials)
{
    rate->events += events;
    rate->trials += trials;
}

void sim_level_count(enum sim_level_crowd crowd, const struct sim_visit *visits, size_t n_visits,
                     struct sim_level_counts *counts)
{
    const struct sim_visit_summary summary = sim_visit_judge(visits, n_visits);
    if (crowd == SIM_CROWD_PEOPLE) {
        add(&counts->refused, summary.probes - summary.probes_admitted, summary.probes);
    }
    add(crowd == SIM_CROWD_PEOPLE ? &counts->strangers : &counts->alike, summary.impostors_let_in,
        summary.impostors);
}

static void print_rate(struct sim_rate rate, FILE *out)
{
    const struct sim_interval interval = sim_rate_exact_interval(rate);
    if (rate.trials == 0) {
        fputs(" not measured |", out);
        return;
    }
    fprintf(out, " %.1f %% [%.2f, %.2f] (%zu of %zu) |", 100.0 * sim_rate_value(rate),
            100.0 * interval.low, 100.0 * interval.high, rate.events, rate.trials);
}

void sim_level_print(const struct sim_level_counts counts[SIM_LEVELS], FILE *out)
{
    fputs("| `level` | enrolled people refused | strangers let in | look-alikes let in |\n"
          "| --- | --- | --- | --- |\n",
          out);
    for (int level = 0; level < SIM_LEVELS; level++) {
        fprintf(out, "| `%s` |", sim_level_name((enum iso_level)level));
        print_rate(counts[level].refused, out);
        print_rate(counts[level].strangers, out);
        print_rate(counts[level].alike, out);
        fputc('\n', out);
    }
}

static void write_row(enum iso_level level, const char *who, struct sim_rate rate, FILE *out)
{
    const struct sim_interval interval = sim_rate_exact_interval(rate);
    fprintf(out, "%s,%s,%zu,%zu,%.6f,%.6f,%.6f\n", sim_level_name(level), who, rate.events,
            rate.trials, rate.trials > 0 ? sim_rate_value(rate) : 0.0, interval.low, interval.high);
}

static void write_levels(const void *context, FILE *out)
{
    const struct sim_level_counts *counts = context;
    fputs("level,who,errors,visits,rate,low,high\n", out);
    for (int level = 0; level < SIM_LEVELS; level++) {
        write_row((enum iso_level)level, "refused", counts[level].refused, out);
        write_row((enum iso_level)level, "strangers", counts[level].strangers, out);
        write_row((enum iso_level)level, "alike", counts[level].alike, out);
    }
}

int sim_level_write_csv(const char *directory, const struct sim_level_counts counts[SIM_LEVELS],
                        struct iso_fault *fault)
{
    return sim_result_file(directory, "levels.csv", write_levels, counts, fault);
}
