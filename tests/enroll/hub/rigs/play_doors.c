/* Doors of a fleet for the browser test of the hub's pages: each line of the input is a command,
 * and is answered by a line "ok" or a fault.
 *
 *   join DOOR CODE             a door joins with the code of its address
 *   ask DOOR                   it asks the hub, and fetches what it lacks
 *   request DOOR PERSON        it tells the hub of a person who was enrolled at it
 *   events DOOR FIRST LAST     it sends records of its log
 *   person ZONE NAME           a person of the fleet, with a template of these doors
 *   update DOOR STATE VERSION  it asks, and says this of its image, whose board is "pc"
 *
 * usage: play_doors CONNINFO KEY-FILE */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/enroll/hub/rigs/played_door.h"

enum { DOORS = 8, SKIPPED = 2 };

static struct {
    char name[HUB_NAME_SIZE];
    struct played_door door;
    char health[200];
} doors[DOORS];

static struct played_door *door_of(const char *name, bool is_new)
{
    for (int i = 0; i < DOORS; i++) {
        if (strcmp(doors[i].name, name) == 0) {
            return &doors[i].door;
        }
        if (!doors[i].name[0] && is_new) {
            (void)snprintf(doors[i].name, sizeof doors[i].name, "%s", name);
            doors[i].door = (struct played_door){.algorithm = 3};
            (void)crypto_sign_keypair(doors[i].door.signs.public, doors[i].door.signs.secret);
            (void)crypto_box_keypair(doors[i].door.receives.public, doors[i].door.receives.secret);
            return &doors[i].door;
        }
    }
    return NULL;
}

static int ask(struct played_door *door, struct hub_store *store, struct iso_fault *fault)
{
    int error = played_door_ask(door, store, fault);

    if (!error) {
        played_door_fetch(door, store);
        error = played_door_ask(door, store, fault);
    }
    return error ? error : hub_door_set_online(store, &door->id, true, fault);
}

static int add_person(struct hub_store *store, const char *zone_name, const char *name,
                      struct iso_fault *fault)
{
    const struct iso_fleet_person person = store_rig_person(name, 3, 1, 1);
    struct hub_zone zone;
    const int error = hub_zone_find(store, zone_name, &zone, fault);

    return error ? error : hub_person_put(store, &person, &zone.place.zone, 1, fault);
}

/* What a door says of its image from now on. */
static void set_image(struct played_door *door, const char *state, const char *version)
{
    for (int i = 0; i < DOORS; i++) {
        if (door == &doors[i].door) {
            (void)snprintf(doors[i].health, sizeof doors[i].health,
                           "{\"update-state\":\"%s\",\"image-version\":\"%s\","
                           "\"image-board\":\"pc\"}",
                           state, version);
            door->health = doors[i].health;
        }
    }
}

static int obey(struct hub_store *store, char *line, struct iso_fault *fault)
{
    char *rest = NULL;
    const char *what = strtok_r(line, " \n", &rest), *name = strtok_r(NULL, " \n", &rest);
    const char *first = strtok_r(NULL, " \n", &rest), *second = strtok_r(NULL, " \n", &rest);
    struct played_door *door = what && name ? door_of(name, strcmp(what, "join") == 0) : NULL;

    if (what && strcmp(what, "person") == 0 && first) {
        return add_person(store, name, first, fault);
    }
    if (!door) {
        return iso_fault_set(fault, -1, "a door is missing");
    }
    if (strcmp(what, "join") == 0 && first) {
        return played_door_join_with(door, store, first, fault);
    }
    if (strcmp(what, "request") == 0 && first) {
        const struct iso_fleet_person person = store_rig_person(first, 3, 1, 7);
        return played_door_request(door, store, &person, fault);
    }
    if (strcmp(what, "events") == 0 && second) {
        return played_door_send_events(door, store, strtoull(first, NULL, 10),
                                       strtoull(second, NULL, 10), fault);
    }
    if (strcmp(what, "update") == 0 && second) {
        set_image(door, first, second);
    }
    return ask(door, store, fault);
}

int main(int argc, char **argv)
{
    struct iso_fault fault = {.text = ""};
    struct hub_store store;
    char line[512];

    if (argc != 3 || iso_fleet_start(&fault)) {
        return SKIPPED;
    }
    const struct hub_store_options options = {
        .conninfo = argv[1], .key_file = argv[2], .hub_name = "head office", .actor = "hub"};
    if (hub_store_open(&options, &store, &fault)) {
        fprintf(stderr, "%s\n", fault.text);
        return 1;
    }
    while (fgets(line, sizeof line, stdin)) {
        puts(obey(&store, line, &fault) ? fault.text : "ok");
        (void)fflush(stdout);
    }
    hub_store_close(&store);
    return 0;
}
