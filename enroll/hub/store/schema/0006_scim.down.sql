DROP TABLE scim_allowance, scim_loss, scim_zone, scim_member, scim_group, scim_user, scim_token;
