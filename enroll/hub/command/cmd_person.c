/* person. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sodium.h>

#include "drivers/file/file.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/store/hub_zone.h"

static int find(struct hub_run *run, struct hub_person *out)
{
    return hub_person_find(&run->store, run->arguments.words[0], out, &run->fault);
}

static int print_person(void *context, const struct hub_person *person)
{
    char from[HUB_TIME_TEXT_SIZE], until[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%-32s %2u templates  valid %s to %s%s  zones", person->name, person->templates,
           hub_time_text(person->valid_from_s, from), hub_time_text(person->valid_until_s, until),
           person->offline_ok ? "  offline-ok" : "");
    for (size_t i = 0; i < person->n_zones; i++) {
        printf("%s %s", i > 0 ? "," : "", person->zone_names[i]);
    }
    putchar('\n');
    return 0;
}

static int list(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    const struct hub_person_filter filter = {.part = a->search,
                                             .zone = a->n_zones > 0 ? &zones[0] : NULL,
                                             .unseen = a->given & HUB_OPTION_UNSEEN,
                                             .most = a->count};
    if (a->n_zones > 1) {
        return iso_fault_set(&run->fault, -EINVAL, "person list: one --zone at most");
    }
    const int error = hub_run_zones(run, zones);
    return error ? error : hub_person_each(&run->store, &filter, print_person, NULL, &run->fault);
}

static int show(struct hub_run *run)
{
    struct hub_person person;
    char text[ISO_FLEET_ID_TEXT_SIZE], time[HUB_TIME_TEXT_SIZE];
    const int error = find(run, &person);
    if (error) {
        return error;
    }
    (void)print_person(NULL, &person);
    printf("id           %s\n", iso_fleet_id_text(&person.id, text));
    printf("enrolled     %s\n", hub_time_text(person.enrolled_s, time));
    printf("revision     %llu\n", (unsigned long long)person.revision);
    return 0;
}

static int revoke(struct hub_run *run)
{
    struct hub_person person;
    int error = find(run, &person);
    error = error ? error : hub_person_revoke(&run->store, &person.id, &run->fault);
    return error ? error : hub_run_confirm(run, person.zones, person.n_zones);
}

static int rename_person(struct hub_run *run)
{
    struct hub_person person;
    const int error = find(run, &person);
    return error ? error
                 : hub_person_rename(&run->store, &person.id, run->arguments.words[1], &run->fault);
}

static int limit(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    struct hub_person person;
    int error = find(run, &person);
    error = error
                ? error
                : hub_person_set_validity(
                      &run->store, &person.id,
                      a->given & HUB_OPTION_FROM ? a->from_s : person.valid_from_s,
                      a->given & HUB_OPTION_UNTIL ? a->until_s : person.valid_until_s, &run->fault);
    return error ? error : hub_run_confirm(run, person.zones, person.n_zones);
}

static int offline(struct hub_run *run)
{
    const char *word = run->arguments.words[1];
    const bool ok = strcmp(word, "yes") == 0;
    struct hub_person person;
    if (!ok && strcmp(word, "no") != 0) {
        return iso_fault_set(&run->fault, -EINVAL, "%s: is neither yes nor no", word);
    }
    const int error = find(run, &person);
    return error ? error : hub_person_set_offline(&run->store, &person.id, ok, &run->fault);
}

static int move(struct hub_run *run)
{
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    struct hub_person person;
    int error = find(run, &person);
    error = error ? error : hub_run_zones(run, zones);
    error = error ? error
                  : hub_person_set_zones(&run->store, &person.id, zones, run->arguments.n_zones,
                                         &run->fault);
    return error ? error : hub_run_confirm(run, person.zones, person.n_zones);
}

/* The credential may contain PINs, so it comes from a file and not from the command line. */
static int credential(struct hub_run *run)
{
    struct hub_person person;
    char *text = NULL;
    size_t size = 0;
    int error = find(run, &person);
    error = error ? error
                  : iso_file_read(run->arguments.words[1], ISO_FLEET_CREDENTIAL_MAX, &text, &size,
                                  &run->fault);
    if (!error && strlen(text) != size) {
        error = iso_fault_set(&run->fault, -EINVAL, "%s: contains a zero byte",
                              run->arguments.words[1]);
    }
    error = error ? error : hub_person_set_credential(&run->store, &person.id, text, &run->fault);
    if (text) {
        sodium_memzero(text, size);
        free(text);
    }
    return error;
}

const struct hub_command hub_person_commands[] = {
    HUB_COMMAND("person list", "[--zone ZONE] [--search TEXT] [--unseen] [--count N]",
                "list people; --unseen: those who must be seen again by another algorithm",
                HUB_OPTION_ZONE | HUB_OPTION_SEARCH | HUB_OPTION_UNSEEN | HUB_OPTION_COUNT, 0, 0,
                list),
    HUB_COMMAND("person show", "PERSON", "show a person", 0, 1, 1, show),
    HUB_COMMAND("person rename", "PERSON NAME", "rename a person", 0, 2, 2, rename_person),
    HUB_COMMAND("person limit", "PERSON [--from DAY] [--until DAY] [--wait SECONDS]",
                "limit when a person may enter; none: no limit",
                HUB_OPTION_FROM | HUB_OPTION_UNTIL | HUB_OPTION_WAIT, 1, 1, limit),
    HUB_COMMAND("person offline", "PERSON yes|no",
                "admit a person at doors that are cut off for long", 0, 2, 2, offline),
    HUB_COMMAND("person move", "PERSON --zone ZONE... [--wait SECONDS]",
                "move a person to other zones", HUB_OPTION_ZONE | HUB_OPTION_WAIT, 1, 1, move),
    HUB_COMMAND("person credential", "PERSON FILE", "set cards, PINs and profiles from a JSON file",
                0, 2, 2, credential),
    HUB_COMMAND("person revoke", "PERSON [--wait SECONDS]",
                "delete a person at the hub and at all doors", HUB_OPTION_WAIT, 1, 1, revoke),
    {.words = NULL},
};
