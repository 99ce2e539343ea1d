/* isotherm-sim visit: the people of a corpus come to the door of a running daemon. */
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "sim/commands.h"
#include "sim/options.h"
#include "sim/visit/visit.h"
#include "sim/visit/visit_report.h"

struct arguments {
    struct sim_visit_options visit;
    const char *out;
};

/* "probe,impostor": one role or more, in any order. */
static int parse_roles(const char *text, void *field)
{
    bool roles[SIM_ROLES] = {false};

    for (;;) {
        const size_t length = strcspn(text, ",");
        int role = 0;
        while (role < SIM_ROLES && (strlen(sim_role_name((enum sim_role)role)) != length ||
                                    strncmp(sim_role_name((enum sim_role)role), text, length))) {
            role++;
        }
        if (role == SIM_ROLES) {
            return -EINVAL;
        }
        roles[role] = true;
        if (!text[length]) {
            memcpy(field, roles, sizeof roles);
            return 0;
        }
        text += length + 1;
    }
}

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(visit.corpus)},
    {"slot", "LINK", "the symbolic link that the daemon's sensor plays", sim_option_text,
     FIELD(visit.slot)},
    {"bus", "ADDRESS", "the message bus of the daemon", sim_option_text, FIELD(visit.address)},
    {"out", "DIR", "where visits.csv goes (made if it is missing)", sim_option_text, FIELD(out)},
    {"role", "ROLES", "who comes: probe,impostor", parse_roles, FIELD(visit.roles)},
    {"settle-ms", "N", "longer than decision.gap_ms of the daemon (1000)", sim_option_int,
     FIELD(visit.settle_ms)},
    {"limit-ms", "N", "a visit's longest time (30000)", sim_option_int, FIELD(visit.limit_ms)},
};

static void print_visit(const struct sim_visit *visit, void *context)
{
    (void)context;
    sim_visit_print(visit, stdout);
    fflush(stdout);
}

static int visit_all(const struct arguments *arguments, struct sim_visit_summary *summary,
                     struct iso_fault *fault)
{
    struct sim_corpus *corpus = NULL;
    struct sim_visit *visits = NULL;
    size_t n_visits = 0;
    int error;

    if (mkdir(arguments->out, 0777) != 0 && errno != EEXIST) {
        return iso_fault_set(fault, -errno, "%s: %s", arguments->out, strerror(errno));
    }
    error = sim_corpus_read(arguments->visit.corpus, &corpus, fault);
    if (error) {
        return error;
    }
    visits = calloc(corpus->n_rows, sizeof *visits);
    if (!visits) {
        error = iso_fault_set(fault, -ENOMEM, "out of memory");
        goto out;
    }
    sim_visit_print_head(stdout);
    error = sim_visit_play(&arguments->visit, corpus, print_visit, NULL, visits, &n_visits, fault);
    error = error ? error : sim_visit_write_csv(arguments->out, visits, n_visits, fault);
    if (!error) {
        *summary = sim_visit_judge(visits, n_visits);
        sim_visit_print_summary(summary, stdout);
    }
out:
    free(visits);
    sim_corpus_free(corpus);
    return error;
}

static int complain(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim visit: %s\n", fault->text);
    return exit_code;
}

int sim_cmd_visit(int argc, char **argv)
{
    struct arguments arguments = {.visit = sim_visit_options_default()};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    struct sim_visit_summary summary = {0};
    struct iso_fault fault = {""};

    switch (sim_options_parse(argc, argv, &set, 1, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim visit --corpus DIR --slot LINK --bus ADDRESS --out DIR "
             "[OPTION...]\n\n"
             "Has the people of a corpus come to the door of a running isothermd whose sensor "
             "plays\nthe slot, one after the other, and tells what it made of them. Exit status 1: "
             "somebody\nenrolled was refused at every visit or taken for another, or a stranger "
             "was let in.\n");
        sim_options_help(&set, 1, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(&fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (!arguments.visit.corpus || !arguments.visit.slot || !arguments.visit.address ||
        !arguments.out) {
        (void)iso_fault_set(&fault, 0, "--corpus, --slot, --bus and --out are needed");
        return complain(&fault, SIM_EXIT_USAGE);
    }
    const int error = visit_all(&arguments, &summary, &fault);
    if (error) {
        return complain(&fault, error == -ENOENT      ? SIM_EXIT_NOT_FOUND
                                : error == -ETIMEDOUT ? SIM_EXIT_TIMED_OUT
                                                      : SIM_EXIT_FAULT);
    }
    return summary.good ? SIM_EXIT_OK : SIM_EXIT_NO_MATCH;
}
