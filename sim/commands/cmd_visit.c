/* isotherm-sim visit: plays the people of a corpus at the door of a running daemon. */
#include <errno.h>
#include <stddef.h>
#include <string.h>

#include "sim/commands/commands.h"
#include "sim/commands/visit_command.h"

struct arguments {
    struct sim_visit_options visit;
    const char *out;
};

/* Reads "probe,impostor": one or more roles, in any order. */
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
    {"role", "ROLES", "roles of the rows to play (probe,impostor)", parse_roles,
     FIELD(visit.roles)},
    {"settle-ms", "N", "longer than decision.gap_ms of the daemon (1000)", sim_option_int,
     FIELD(visit.settle_ms)},
    {"limit-ms", "N", "longest time of a visit (30000)", sim_option_int, FIELD(visit.limit_ms)},
};

static const char usage[] =
    "Usage: isotherm-sim visit --corpus DIR --slot LINK --bus ADDRESS --out DIR [OPTION...]\n\n"
    "Plays the people of a corpus, one after the other, at the door of a running isothermd\n"
    "whose sensor plays the slot, and prints the verdicts. Exit status 1: an enrolled person was\n"
    "refused at every visit or admitted under another name, or a stranger was let in.\n";

static bool is_complete(const void *target)
{
    const struct arguments *arguments = target;
    const struct sim_visit_options *visit = &arguments->visit;
    return visit->corpus && visit->slot && visit->address && arguments->out;
}

static int play(const void *target, const struct sim_corpus *corpus, sim_visit_listener *listener,
                void *context, struct sim_visit *visits, size_t *n_visits, struct iso_fault *fault)
{
    const struct arguments *arguments = target;
    return sim_visit_play(&arguments->visit, corpus, listener, context, visits, n_visits, fault);
}

int sim_cmd_visit(int argc, char **argv)
{
    struct arguments arguments = {.visit = sim_visit_options_default()};
    const struct sim_visit_command command = {
        .name = "visit",
        .usage = usage,
        .needed = "--corpus, --slot, --bus and --out are needed",
        .set = {options, sizeof options / sizeof *options, &arguments},
        .corpus = &arguments.visit.corpus,
        .out = &arguments.out,
        .out_may_exist = true,
        .is_complete = is_complete,
        .play = play,
    };
    return sim_visit_command_run(&command, argc, argv);
}
