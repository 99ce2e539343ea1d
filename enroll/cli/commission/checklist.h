/* What is checked before a door goes into service, in the order in which it is done. This is the
 * one list: board/commissioning.md shows it, and a test compares the two. */
#ifndef CLI_COMMISSION_CHECKLIST_H
#define CLI_COMMISSION_CHECKLIST_H

#include <stdbool.h>

/* How an item is checked. */
enum cli_check_way {
    CLI_WAY_FINDING, /* by a finding of the doctor */
    CLI_WAY_OTHERS,  /* by all findings of the doctor that belong to no other item */
    CLI_WAY_FRAMES,  /* by counting frames for some seconds */
    CLI_WAY_KEY,     /* by where the key of the appliance is */
    CLI_WAY_LOG,     /* by verifying every record of the audit log */
    CLI_WAY_RELAY,   /* by switching the relay, if the person agrees */
    CLI_WAY_PERSON,  /* by asking the person */
};

struct cli_checklist_item {
    const char *item; /* its word in answers, in the audit log and on the page */
    enum cli_check_way way;
    const char *subject; /* CLI_WAY_FINDING: of the finding (diagnosis.c); else NULL */
    const char *text;    /* what has to be so, or a question to the person */
};

enum { CLI_CHECKLIST_ITEMS = 31 };

extern const struct cli_checklist_item cli_checklist[CLI_CHECKLIST_ITEMS];

/* Whether a person has to answer. */
bool cli_checklist_asks(const struct cli_checklist_item *item);

/* The fewest frames a second with which an appliance may go into service. A visit needs several
 * usable frames; with fewer frames people wait longer than they are used to. */
enum { CLI_CHECKLIST_FRAMES_PER_S = 5 };

#endif
