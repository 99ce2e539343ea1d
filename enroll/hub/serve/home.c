#include "enroll/hub/serve/service.h"
void hub__home_publish(struct hub_service *service, bool everything)
{
    (void)service;
    (void)everything;
}
