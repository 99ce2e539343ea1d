/* door. */
#include <stdio.h>

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/store/hub_door.h"

static int find(struct hub_run *run, struct hub_door *out)
{
    return hub_door_find(&run->store, run->arguments.words[0], out, &run->fault);
}

static int add(struct hub_run *run)
{
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX], id;
    char code[HUB_CODE_SIZE];
    int error = hub_run_zones(run, zones);
    error = error ? error
                  : hub_door_add(&run->store, run->arguments.words[0], zones,
                                 run->arguments.n_zones, &id, code, &run->fault);
    return error ? error : hub_print_address(run, code);
}

static int new_code(struct hub_run *run)
{
    struct hub_door door;
    char code[HUB_CODE_SIZE];
    int error = find(run, &door);
    error = error ? error : hub_door_new_code(&run->store, &door.id, code, &run->fault);
    return error ? error : hub_print_address(run, code);
}

static const char *state_of(const struct hub_door *door)
{
    return door->expelled_s  ? "expelled"
           : !door->joined_s ? "not joined"
           : door->online    ? "online"
                             : "offline";
}

static int print_door(void *context, const struct hub_door *door)
{
    char text[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%-24s %-10s  last report %-19s  events %llu of %llu  zones", door->name, state_of(door),
           hub_time_text(door->reported_s, text), (unsigned long long)door->acked,
           (unsigned long long)door->last_event);
    for (size_t i = 0; i < door->n_zones; i++) {
        printf("%s %s", i > 0 ? "," : "", door->zone_names[i]);
    }
    putchar('\n');
    return 0;
}

static int list(struct hub_run *run)
{
    return hub_door_each(&run->store, run->arguments.given & HUB_OPTION_ALL, print_door, NULL,
                         &run->fault);
}

static int show(struct hub_run *run)
{
    struct hub_door door;
    char text[ISO_FLEET_ID_TEXT_SIZE], time[HUB_TIME_TEXT_SIZE];
    const int error = find(run, &door);
    if (error) {
        return error;
    }
    (void)print_door(NULL, &door);
    printf("id           %s\n", iso_fleet_id_text(&door.id, text));
    printf("joined       %s\n", hub_time_text(door.joined_s, time));
    printf("its clock    %s\n", hub_time_text(door.door_time_s, time));
    printf("algorithm    %u\n", door.algorithm);
    if (*door.health) {
        printf("health       %s\n", door.health);
    }
    return 0;
}

static int move(struct hub_run *run)
{
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    struct hub_door door;
    int error = find(run, &door);
    error = error ? error : hub_run_zones(run, zones);
    return error ? error
                 : hub_door_move(&run->store, &door.id, zones, run->arguments.n_zones, &run->fault);
}

static int expel(struct hub_run *run)
{
    struct hub_door door;
    const int error = find(run, &door);
    return error ? error : hub_door_expel(&run->store, &door.id, &run->fault);
}

const struct hub_command hub_door_commands[] = {
    HUB_COMMAND("door add", "NAME --zone ZONE...",
                "add a door, and print the address with which it joins", HUB_OPTION_ZONE, 1, 1,
                add),
    HUB_COMMAND("door code", "DOOR", "print a new address for a door that has not joined", 0, 1, 1,
                new_code),
    HUB_COMMAND("door list", "[--all]", "list the doors; --all: also expelled ones", HUB_OPTION_ALL,
                0, 0, list),
    HUB_COMMAND("door show", "DOOR", "show what a door has reported", 0, 1, 1, show),
    HUB_COMMAND("door move", "DOOR --zone ZONE...",
                "move a door to other zones; the first is its home", HUB_OPTION_ZONE, 1, 1, move),
    HUB_COMMAND("door expel", "DOOR", "take a door out of the fleet; its zones get new keys", 0, 1,
                1, expel),
    {.words = NULL},
};
