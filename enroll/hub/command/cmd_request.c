/* request. */
#include <stdio.h>

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/people/hub_request.h"

static int find(struct hub_run *run, struct hub_request *out)
{
    return hub_request_find(&run->store, run->arguments.words[0], out, &run->fault);
}

static int print_request(void *context, const struct hub_request *request)
{
    static const char *const states[] = {"waits", "approved", "rejected"};
    char id[ISO_FLEET_ID_TEXT_SIZE], time[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%s  %-32s at %-24s %s  %s\n", iso_fleet_id_text(&request->person, id), request->name,
           request->door_name, hub_time_text(request->time_s, time), states[request->state]);
    return 0;
}

static int list(struct hub_run *run)
{
    return hub_request_each(&run->store, run->arguments.given & HUB_OPTION_ALL, print_request, NULL,
                            &run->fault);
}

static int approve(struct hub_run *run)
{
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    struct hub_request request;
    int error = find(run, &request);
    error = error ? error : hub_run_zones(run, zones);
    return error ? error
                 : hub_request_approve(&run->store, &request.person, zones, run->arguments.n_zones,
                                       &run->fault);
}

static int reject(struct hub_run *run)
{
    struct hub_request request;
    const int error = find(run, &request);
    return error ? error : hub_request_reject(&run->store, &request.person, &run->fault);
}

const struct hub_command hub_request_commands[] = {
    HUB_COMMAND("request list", "[--all]",
                "list the people who were enrolled at doors and wait for approval", HUB_OPTION_ALL,
                0, 0, list),
    HUB_COMMAND("request approve", "PERSON [--zone ZONE...]",
                "let such a person into zones; not given: the home zone of the door",
                HUB_OPTION_ZONE, 1, 1, approve),
    HUB_COMMAND("request reject", "PERSON", "refuse such a person; the door forgets the face", 0, 1,
                1, reject),
    {.words = NULL},
};
