/* What the handlers share. Internal to enroll/hub/api. */
#ifndef HUB_API_API_INNER_H
#define HUB_API_API_INNER_H

#include <jansson.h>

#include "enroll/hub/api/hub_api.h"

/* ---- api_session.c ---- */
void hub__api_get_session(void *api, struct web_exchange *exchange);
void hub__api_login(void *api, struct web_exchange *exchange);
void hub__api_logout(void *api, struct web_exchange *exchange);
void hub__api_setup(void *api, struct web_exchange *exchange);

/* ---- api_zones.c ---- */
void hub__api_list_zones(void *api, struct web_exchange *exchange);
void hub__api_list_doors(void *api, struct web_exchange *exchange);
void hub__api_zone_lockdown(void *api, struct web_exchange *exchange);
void hub__api_lockdown(void *api, struct web_exchange *exchange);

/* ---- api_people.c ---- */
void hub__api_list_people(void *api, struct web_exchange *exchange);
void hub__api_revoke_person(void *api, struct web_exchange *exchange);
void hub__api_list_requests(void *api, struct web_exchange *exchange);
void hub__api_approve(void *api, struct web_exchange *exchange);
void hub__api_reject(void *api, struct web_exchange *exchange);

/* ---- api_events.c ---- */
void hub__api_list_events(void *api, struct web_exchange *exchange);
void hub__api_list_acts(void *api, struct web_exchange *exchange);

/* ---- hub_api.c ---- */

/* Answers an error of the store as a problem. */
void hub__api_problem(struct web_exchange *exchange, int error, const struct iso_fault *fault);

/* Answers {"name": list}, or the error if there is one. Takes over the list; NULL: no memory. */
void hub__api_list(struct web_exchange *exchange, const char *name, json_t *list, int error,
                   const struct iso_fault *fault);

/* Runs a change in the name of the account that asks: the store records it so. */
struct hub__api_actor {
    char before[HUB_ACTOR_SIZE];
};
void hub__api_act(struct hub_api *api, const struct web_exchange *exchange,
                  struct hub__api_actor *actor);
void hub__api_acted(struct hub_api *api, const struct hub__api_actor *actor);

/* The text of a member of the body; NULL after 400 "invalid-member" if it is missing or is longer
 * than `most` bytes. */
const char *hub__api_text(struct web_exchange *exchange, const char *member, size_t most);

/* A UUID as JSON. */
json_t *hub__api_id(const struct iso_fleet_id *id);

#endif
