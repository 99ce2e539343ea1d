/* event, act. */
#include <stdio.h>

#include "enroll/hub/answer/hub_event.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/store/hub_door.h"

enum { STANDARD_COUNT = 50 };

static uint32_t count_of(const struct hub_run *run)
{
    return run->arguments.given & HUB_OPTION_COUNT ? run->arguments.count : STANDARD_COUNT;
}

static int print_event(void *context, const struct hub_event *event)
{
    (void)context;
    printf("%s %llu %s\n", event->door_name, (unsigned long long)event->number, event->record);
    return 0;
}

static int list(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    struct hub_door door;
    const struct hub_event_filter filter = {.door = a->door ? &door.id : NULL,
                                            .person = a->person,
                                            .event = a->event,
                                            .since = a->since,
                                            .most = count_of(run)};
    const int error = a->door ? hub_door_find(&run->store, a->door, &door, &run->fault) : 0;
    return error ? error : hub_event_each(&run->store, &filter, print_event, NULL, &run->fault);
}

static int print_act(void *context, const struct hub_act *act)
{
    char time[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%lld %s %s %s %s %s -> %s\n", (long long)act->number, hub_time_text(act->time_s, time),
           act->actor, act->what, act->object, *act->before ? act->before : "-",
           *act->after ? act->after : "-");
    return 0;
}

static int list_acts(struct hub_run *run)
{
    return hub_act_each(&run->store, count_of(run), print_act, NULL, &run->fault);
}

const struct hub_command hub_event_commands[] = {
    HUB_COMMAND("event list",
                "[--door DOOR] [--person NAME] [--event WORD] [--since TIME] [--count N]",
                "list the newest records of the doors' logs",
                HUB_OPTION_DOOR | HUB_OPTION_PERSON | HUB_OPTION_EVENT | HUB_OPTION_SINCE |
                    HUB_OPTION_COUNT,
                0, 0, list),
    HUB_COMMAND("act list", "[--count N]", "list what people have changed at the hub",
                HUB_OPTION_COUNT, 0, 0, list_acts),
    {.words = NULL},
};
