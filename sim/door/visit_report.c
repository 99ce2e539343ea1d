#include "sim/door/visit_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "drivers/terminal/terminal.h"
#include "sim/base/result_file.h"

static const char *verdict_name(const struct sim_visit *visit)
{
    if (!visit->verdict.given) {
        return "none";
    }
    return visit->verdict.allow ? "allow" : "deny";
}

static enum iso_paint verdict_paint(const struct sim_visit *visit)
{
    if (!visit->verdict.given) {
        return ISO_PAINT_WARNING;
    }
    return visit->verdict.allow ? ISO_PAINT_GOOD : ISO_PAINT_BAD;
}

/* The numbers of a verdict; NaN where unknown. */
struct figures {
    double score, threshold, frames, latency_ms;
};

static struct figures figures_of(const struct sim_door_verdict *verdict)
{
    if (!verdict->given) {
        return (struct figures){NAN, NAN, NAN, NAN};
    }
    return (struct figures){verdict->score, verdict->threshold, verdict->frames,
                            (double)verdict->latency_us / 1000};
}

static const char *door_name(const struct sim_visit *visit)
{
    return visit->unlocked ? "unlocked" : "locked";
}

/* The reason of the verdict; "" without a verdict. */
static const char *reason_of(const struct sim_visit *visit)
{
    return visit->verdict.given ? visit->verdict.reason : "";
}

/* Prints a number right-aligned in `width` columns, or "-" if it is unknown. */
static void print_number(double value, int width, int decimals, FILE *out)
{
    if (isfinite(value)) {
        fprintf(out, " %*.*f", width, decimals, value);
    } else {
        fprintf(out, " %*s", width, "-");
    }
}

void sim_visit_print_head(FILE *out)
{
    fprintf(out, "%-12s %-9s %-10s %-7s %-12s %8s %9s %6s %6s  %-8s %s\n", "visitor", "role",
            "note", "verdict", "named", "score", "threshold", "frames", "ms", "door", "reason");
}

void sim_visit_print(const struct sim_visit *visit, FILE *out)
{
    const struct sim_door_verdict *verdict = &visit->verdict;
    const struct figures figures = figures_of(verdict);
    const struct sim_corpus_row *row = visit->row;

    const struct iso_terminal terminal = iso_terminal_of(out);
    fprintf(out, "%-12s %-9s %-10s %s%-7s%s %-12s", row->subject, sim_role_name(row->role),
            row->note[0] ? row->note : row->expression,
            iso_terminal_paint(&terminal, verdict_paint(visit)), verdict_name(visit),
            iso_terminal_paint(&terminal, ISO_PAINT_PLAIN),
            verdict->given && verdict->person[0] ? verdict->person : "-");
    print_number(figures.score, 8, 2, out);
    print_number(figures.threshold, 9, 2, out);
    print_number(figures.frames, 6, 0, out);
    print_number(figures.latency_ms, 6, 0, out);
    fprintf(out, "  %-8s %s\n", door_name(visit), reason_of(visit));
}

void sim_visit_print_summary(const struct sim_visit_summary *summary, FILE *out)
{
    const struct iso_terminal terminal = iso_terminal_of(out);
    fprintf(out,
            "%zu of %zu enrolled people admitted (at %zu of their %zu visits); %zu under another "
            "name;\n%zu of %zu visits of strangers and non-faces admitted: %s%s%s\n",
            summary->people_admitted, summary->people, summary->probes_admitted, summary->probes,
            summary->misnamed, summary->impostors_let_in, summary->impostors,
            iso_terminal_paint(&terminal, summary->good ? ISO_PAINT_GOOD : ISO_PAINT_BAD),
            summary->good ? "good" : "NOT GOOD", iso_terminal_paint(&terminal, ISO_PAINT_PLAIN));
}

static void write_number(double value, int decimals, FILE *out)
{
    if (isfinite(value)) {
        fprintf(out, "%.*f", decimals, value);
    }
    fputc(',', out);
}

static void write_row(const struct sim_visit *visit, FILE *out)
{
    const struct sim_door_verdict *verdict = &visit->verdict;
    const struct figures figures = figures_of(verdict);
    const struct sim_corpus_row *row = visit->row;

    fprintf(out, "%s,%s,%s,%s,%s,%s,", row->recording, row->subject, sim_role_name(row->role),
            row->note, verdict_name(visit), verdict->given ? verdict->person : "");
    write_number(figures.score, 6, out);
    write_number(figures.threshold, 6, out);
    write_number(figures.frames, 0, out);
    write_number(figures.latency_ms, 3, out);
    fprintf(out, "%s,%s\n", door_name(visit), reason_of(visit));
}

struct all_visits {
    const struct sim_visit *visits;
    size_t n;
};

static void write_visits(const void *context, FILE *out)
{
    const struct all_visits *all = context;
    fputs("recording,subject,role,note,verdict,person,score,threshold,frames,latency_ms,door,"
          "reason\n",
          out);
    for (size_t i = 0; i < all->n; i++) {
        write_row(&all->visits[i], out);
    }
}

int sim_visit_write_csv(const char *directory, const struct sim_visit *visits, size_t n_visits,
                        struct iso_fault *fault)
{
    const struct all_visits all = {visits, n_visits};
    return sim_result_file(directory, "visits.csv", write_visits, &all, fault);
}
