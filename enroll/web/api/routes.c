#include <stddef.h>

#include "enroll/web/api/api.h"

const struct web_route web_api_routes[] = {
    {"GET", "/openapi.json", WEB_ROLE_NONE, web_api_get_document},
    {"GET", "/session", WEB_ROLE_NONE, web_api_get_session},
    {"POST", "/session", WEB_ROLE_NONE, web_api_login},
    {"DELETE", "/session", WEB_ROLE_NONE, web_api_logout},
    {"PUT", "/session/password", WEB_ROLE_OBSERVER, web_api_set_own_password},
    {"POST", "/setup", WEB_ROLE_NONE, web_api_setup},
    {"GET", "/accounts", WEB_ROLE_ADMINISTRATOR, web_api_list_accounts},
    {"POST", "/accounts", WEB_ROLE_ADMINISTRATOR, web_api_add_account},
    {"PATCH", "/accounts/{name}", WEB_ROLE_ADMINISTRATOR, web_api_change_account},
    {"DELETE", "/accounts/{name}", WEB_ROLE_ADMINISTRATOR, web_api_remove_account},
    {"GET", "/status", WEB_ROLE_OBSERVER, web_api_get_status},
    {"GET", "/health", WEB_ROLE_OBSERVER, web_api_get_health},
    {"GET", "/settings", WEB_ROLE_ADMINISTRATOR, web_api_get_settings},
    {"PUT", "/lockdown", WEB_ROLE_ADMINISTRATOR, web_api_set_lockdown},
    {"DELETE", "/lockout", WEB_ROLE_ADMINISTRATOR, web_api_clear_lockout},
    {"GET", "/events", WEB_ROLE_OBSERVER, web_api_get_events},
    {"GET", "/outline", WEB_ROLE_OBSERVER, web_api_get_outline},
    {"GET", "/relief", WEB_ROLE_ENROLLER, web_api_get_relief},
    {"GET", "/people", WEB_ROLE_ENROLLER, web_api_list_people},
    {"PATCH", "/people/{name}", WEB_ROLE_ADMINISTRATOR, web_api_change_person},
    {"DELETE", "/people/{name}", WEB_ROLE_ADMINISTRATOR, web_api_remove_person},
    {"GET", "/enrolment", WEB_ROLE_ENROLLER, web_api_get_enrolment},
    {"POST", "/enrolment", WEB_ROLE_ENROLLER, web_api_begin_enrolment},
    {"DELETE", "/enrolment", WEB_ROLE_ENROLLER, web_api_end_enrolment},
    {"GET", "/log", WEB_ROLE_ADMINISTRATOR, web_api_read_log},
    {"POST", "/log/verification", WEB_ROLE_ADMINISTRATOR, web_api_verify_log},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};
