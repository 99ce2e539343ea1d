/* Plays the visitors of a corpus at the door of a running daemon, one after the other. */
#ifndef SIM_DOOR_VISIT_H
#define SIM_DOOR_VISIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sim/corpus/corpus.h"
#include "sim/door/door_watch.h"

struct sim_visit_options {
    const char *corpus;  /* directory */
    const char *slot;    /* the link whose target the daemon's sensor plays */
    const char *address; /* of the bus */
    bool roles[SIM_ROLES];
    int settle_ms; /* longer than the daemon's decision.gap_ms. A verdict comes within this time
                      after a visitor's last frame or not at all; the door also stays empty for this
                      time between two visits */
    int limit_ms;  /* the longest time of a visit */
};

/* The roles probe and impostor, settle_ms of a second, limit_ms of half a minute. */
struct sim_visit_options sim_visit_options_default(void);

struct sim_visit {
    const struct sim_corpus_row *row;
    struct sim_door_verdict verdict; /* not given: the appliance saw no person */
    bool unlocked;                   /* the door was unlocked during the visit */
};

/* Counts over all visits. */
struct sim_visit_summary {
    size_t people, people_admitted; /* people of role probe; those admitted in at least one visit */
    size_t probes, probes_admitted; /* visits of probes; those admitted under their own name */
    size_t misnamed;                /* visits of probes admitted, but not under their own name */
    size_t impostors, impostors_let_in; /* visits of strangers and of non-faces; those admitted */
    bool good; /* each enrolled person was admitted at least once, no visit was misnamed, and no
                  impostor was admitted */
};

/* Counts the visits; has no side effects. A visit that must not succeed (of an impostor, or of a
 * probe not under its own name) counts as admitted if the door was unlocked or the verdict was
 * "allow". A visit of a probe under its own name counts as admitted only after the verdict "allow".
 */
struct sim_visit_summary sim_visit_judge(const struct sim_visit *visits, size_t n_visits);

/* Whether one of the visits was of this recording. */
bool sim_visit_was_played(const struct sim_visit *visits, size_t n_visits, const char *recording);

/* Called after each visit. */
typedef void sim_visit_listener(const struct sim_visit *visit, void *context);

/* Plays the rows of the corpus that have one of the roles, each recording once, and leaves the
 * slot empty. *visits has room for all rows of the corpus; *n_visits of them are filled in.
 * Errors of the slot and the bus; -ETIMEDOUT if the door does not lock again. */
int sim_visit_play(const struct sim_visit_options *options, const struct sim_corpus *corpus,
                   sim_visit_listener *listener, void *context, struct sim_visit *visits,
                   size_t *n_visits, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
