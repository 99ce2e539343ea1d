Name: Face recognition by Isotherm (the password remains)
Default: no
Priority: 260
Auth-Type: Primary
Auth:
	[success=end default=ignore]	pam_isotherm.so
