/* The error rates that matter to the owner of a door, for each security level: the share of
 * visits in which enrolled people are refused, and in which strangers, or strangers who look
 * like enrolled people, are admitted. */
#ifndef SIM_DOOR_LEVEL_REPORT_H
#define SIM_DOOR_LEVEL_REPORT_H

#include <stdio.h>

#include "core/base/people_rate.h"
#include "sim/door/rehearsal.h"

/* The kinds of people in a corpus. */
enum sim_level_crowd {
    SIM_CROWD_PEOPLE = 0, /* enrolled people and strangers with the usual variety */
    SIM_CROWD_ALIKE,      /* strangers who look like enrolled people */
};

/* Counted visits of one level. */
struct sim_level_counts {
    /* Enrolled people who are not admitted, or admitted under another name. */
    struct iso_people_rate refused;
    struct iso_people_rate strangers; /* admitted strangers */
    struct iso_people_rate alike;     /* admitted strangers who look like enrolled people */
};

/* Adds the visits of one corpus at one level. From SIM_CROWD_ALIKE only the strangers count. Equal
 * subjects of one corpus are one person; the people of different corpora are different. */
void sim_level_count(enum sim_level_crowd crowd, const struct sim_visit *visits, size_t n_visits,
                     struct sim_level_counts *counts);

/* Prints the head of a table in Markdown. */
void sim_level_print_head(FILE *out);

/* Prints a row of the table for each level: rates in percent, 95 % intervals over people
 * (people_rate.h) and counts. `setting` follows the name of the level; it may be "". */
void sim_level_print(const struct sim_level_counts counts[SIM_LEVELS], const char *setting,
                     FILE *out);

/* Writes DIRECTORY/NAME: level,who,errors,visits,rate,low,high,people. `who` is refused, strangers
 * or alike; rate, low and high are fractions. The errno of writing. */
int sim_level_write_csv(const char *directory, const char *name,
                        const struct sim_level_counts counts[SIM_LEVELS], struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
