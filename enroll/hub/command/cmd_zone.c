/* zone, lockdown, recover. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/store/hub_zone.h"

enum { POLICY_BYTES_MAX = 1 << 20 };

/* The zone that the first word names. */
static int find(struct hub_run *run, size_t word, struct hub_zone *out)
{
    return hub_zone_find(&run->store, run->arguments.words[word], out, &run->fault);
}

static int add(struct hub_run *run)
{
    struct iso_fleet_id id;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    const int error = hub_zone_add(&run->store, run->arguments.words[0], &id, &run->fault);
    if (!error) {
        printf("%s\n", iso_fleet_id_text(&id, text));
    }
    return error;
}

static int print_zone(void *context, const struct hub_zone *zone)
{
    (void)context;
    printf("%-24s %4llu door%s %6llu people  epoch %llu  sequence %llu  lease %u s  local people "
           "%s  approve %s%s%s\n",
           zone->name, (unsigned long long)zone->doors, zone->doors == 1 ? " " : "s",
           (unsigned long long)zone->people, (unsigned long long)zone->place.epoch,
           (unsigned long long)zone->place.sequence, zone->settings.lease_s,
           zone->settings.local_people ? "yes" : "no",
           zone->settings.approve_auto ? "auto" : "person", zone->lockdown ? "  LOCKDOWN" : "",
           zone->behind ? "  BEHIND ITS DOORS: isotherm-hub recover" : "");
    return 0;
}

static int list(struct hub_run *run)
{
    return hub_zone_each(&run->store, print_zone, NULL, &run->fault);
}

static int set(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    struct hub_zone zone;
    const int error = find(run, 0, &zone);
    if (error) {
        return error;
    }
    if (a->given & HUB_OPTION_LEASE) {
        zone.settings.lease_s = a->lease_s;
    }
    if (a->given & HUB_OPTION_LOCAL) {
        zone.settings.local_people = a->local_people;
    }
    if (a->given & HUB_OPTION_APPROVE) {
        zone.settings.approve_auto = a->approve_auto;
    }
    return hub_zone_set(&run->store, &zone.place.zone, &zone.settings, &run->fault);
}

static int set_policy(struct hub_run *run, const struct hub_zone *zone)
{
    const char *path = run->arguments.words[1];
    char *text = NULL;
    size_t size = 0;
    if (strcmp(path, "none") == 0) {
        return hub_zone_set_policy(&run->store, &zone->place.zone, "", &run->fault);
    }
    int error = iso_file_read(path, POLICY_BYTES_MAX, &text, &size, &run->fault);
    if (!error && strlen(text) != size) {
        error = iso_fault_set(&run->fault, -EINVAL, "%s: contains a zero byte", path);
    }
    error = error ? error : hub_zone_set_policy(&run->store, &zone->place.zone, text, &run->fault);
    free(text);
    return error;
}

/* Prints the policy, or sets it and waits for the doors. */
static int policy(struct hub_run *run)
{
    struct hub_zone zone;
    char *document = NULL;
    int error = find(run, 0, &zone);
    if (error) {
        return error;
    }
    if (run->arguments.n_words == 2) {
        error = set_policy(run, &zone);
        return error ? error : hub_run_confirm(run, &zone.place.zone, 1);
    }
    error = hub_zone_get_policy(&run->store, &zone.place.zone, &document, &run->fault);
    if (!error) {
        puts(document);
        free(document);
    }
    return error;
}

static int renew(struct hub_run *run)
{
    struct hub_zone zone;
    const int error = find(run, 0, &zone);
    return error ? error : hub_zone_new_epoch(&run->store, &zone.place.zone, &run->fault);
}

static int recover(struct hub_run *run)
{
    struct hub_zone zone;
    int error = find(run, 0, &zone);
    error = error ? error : hub_zone_recover(&run->store, &zone.place.zone, &run->fault);
    error = error ? error : find(run, 0, &zone);
    if (!error) {
        printf("%s: epoch %llu begins at sequence %llu; its doors take a snapshot\n", zone.name,
               (unsigned long long)zone.place.epoch, (unsigned long long)zone.place.sequence);
    }
    return error;
}

struct ids {
    struct iso_fleet_id *ids;
    size_t n;
    int error;
};

static int keep_id(void *context, const struct hub_zone *zone)
{
    struct ids *ids = context;
    struct iso_fleet_id *grown = realloc(ids->ids, (ids->n + 1) * sizeof *grown);
    if (!grown) {
        return -ENOMEM;
    }
    ids->ids = grown;
    ids->ids[ids->n++] = zone->place.zone;
    return 0;
}

static int lock_all(struct hub_run *run, bool on)
{
    struct ids all = {.n = 0};
    int error = hub_zone_lockdown(&run->store, NULL, on, &run->fault);
    error = error ? error : hub_zone_each(&run->store, keep_id, &all, &run->fault);
    if (error == -ENOMEM) {
        (void)iso_fault_set(&run->fault, error, "zones: no memory");
    }
    error = error ? error : hub_run_confirm(run, all.ids, all.n);
    free(all.ids);
    return error;
}

static int lockdown(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    const bool on = strcmp(a->words[0], "on") == 0;
    struct hub_zone zone;
    if (!on && strcmp(a->words[0], "off") != 0) {
        return iso_fault_set(&run->fault, -EINVAL, "%s: is neither on nor off", a->words[0]);
    }
    if (a->n_words == 1) {
        return lock_all(run, on);
    }
    int error = find(run, 1, &zone);
    error = error ? error : hub_zone_lockdown(&run->store, &zone.place.zone, on, &run->fault);
    return error ? error : hub_run_confirm(run, &zone.place.zone, 1);
}

const struct hub_command hub_zone_commands[] = {
    HUB_COMMAND("zone add", "NAME", "add a zone, a group of doors with the same people", 0, 1, 1,
                add),
    HUB_COMMAND("zone list", "", "list the zones", 0, 0, 0, list),
    HUB_COMMAND("zone set",
                "ZONE [--lease SECONDS] [--local-people yes|no] [--approve auto|person]",
                "change how the doors of a zone act without the hub",
                HUB_OPTION_LEASE | HUB_OPTION_LOCAL | HUB_OPTION_APPROVE, 1, 1, set),
    HUB_COMMAND("zone policy", "ZONE [FILE|none] [--wait SECONDS]",
                "print or set the policy of a zone", HUB_OPTION_WAIT, 1, 2, policy),
    HUB_COMMAND("zone renew", "ZONE", "give the doors of a zone a new key", 0, 1, 1, renew),
    HUB_COMMAND("lockdown", "on|off [ZONE] [--wait SECONDS]", "close a zone, or all, to everybody",
                HUB_OPTION_WAIT, 1, 2, lockdown),
    HUB_COMMAND("recover", "ZONE",
                "begin a zone anew after an old copy of the database was restored", 0, 1, 1,
                recover),
    {.words = NULL},
};
