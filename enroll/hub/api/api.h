/* The handlers of the hub's API. Internal to enroll/hub/api. */
#ifndef HUB_API_API_H
#define HUB_API_API_H

#include "enroll/hub/api/hub_api.h"

/* ---- api_status.c ---- */
void hub__api_get_document(void *api, struct web_exchange *exchange);
void hub__api_get_status(void *api, struct web_exchange *exchange);
void hub__api_list_acts(void *api, struct web_exchange *exchange);

/* ---- api_zones.c ---- */
void hub__api_list_zones(void *api, struct web_exchange *exchange);
void hub__api_add_zone(void *api, struct web_exchange *exchange);
void hub__api_get_zone(void *api, struct web_exchange *exchange);
void hub__api_change_zone(void *api, struct web_exchange *exchange);
void hub__api_get_policy(void *api, struct web_exchange *exchange);
void hub__api_set_policy(void *api, struct web_exchange *exchange);
void hub__api_renew_zone(void *api, struct web_exchange *exchange);
void hub__api_recover_zone(void *api, struct web_exchange *exchange);

/* ---- api_lockdown.c ---- */
void hub__api_get_lockdown(void *api, struct web_exchange *exchange);
void hub__api_set_lockdown(void *api, struct web_exchange *exchange);

/* ---- api_doors.c ---- */
void hub__api_list_doors(void *api, struct web_exchange *exchange);
void hub__api_add_door(void *api, struct web_exchange *exchange);
void hub__api_get_door(void *api, struct web_exchange *exchange);
void hub__api_change_door(void *api, struct web_exchange *exchange);
void hub__api_expel_door(void *api, struct web_exchange *exchange);
void hub__api_new_code(void *api, struct web_exchange *exchange);

/* ---- api_people.c, api_person.c ---- */
void hub__api_list_people(void *api, struct web_exchange *exchange);
void hub__api_get_person(void *api, struct web_exchange *exchange);
void hub__api_change_person(void *api, struct web_exchange *exchange);
void hub__api_revoke_person(void *api, struct web_exchange *exchange);

/* ---- api_requests.c ---- */
void hub__api_list_requests(void *api, struct web_exchange *exchange);
void hub__api_approve_request(void *api, struct web_exchange *exchange);
void hub__api_reject_request(void *api, struct web_exchange *exchange);

/* ---- api_updates.c ---- */
void hub__api_list_updates(void *api, struct web_exchange *exchange);
void hub__api_list_rollout_doors(void *api, struct web_exchange *exchange);
void hub__api_turn_rollout(void *api, struct web_exchange *exchange);

/* ---- api_events.c ---- */
void hub__api_list_events(void *api, struct web_exchange *exchange);

#endif
