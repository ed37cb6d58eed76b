-- Run as PostgreSQL's own user. Running it again does no harm:
--     sudo -u postgres psql --set ON_ERROR_STOP=1 < database.sql
-- Debian's PostgreSQL accepts the system user of the same name, without a password.
SELECT 'CREATE ROLE motionjury LOGIN'
WHERE NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'motionjury') \gexec

SELECT 'CREATE DATABASE "{{ study.database_name }}" OWNER motionjury'
    ' TEMPLATE template0 ENCODING ''UTF8'' LOCALE ''C.UTF-8'''
WHERE NOT EXISTS (SELECT FROM pg_database WHERE datname = '{{ study.database_name }}') \gexec

REVOKE ALL ON DATABASE "{{ study.database_name }}" FROM PUBLIC;
