# Two commands for a newcomer: `make fly` and `make test`. `make help` lists the rest.
PYTHON ?= python3
VENV   ?= .venv
ARGS   ?=

PINS       := $(filter-out requirements/bench.txt requirements/docs.txt,$(wildcard requirements/*.txt))
LIBRARIES  := $(patsubst %/pyproject.toml,%,$(wildcard ros2_ws/src/*/pyproject.toml))
INTERFACES := ros2_ws/src/drone_interfaces \
              ros2_ws/underlay/tf2_msgs ros2_ws/underlay/simulation_interfaces
SOURCES    := $(shell find $(INTERFACES:%=%/) -type f -not -name '*.py' -not -name '*.pyc')
RUN        := $(VENV)/bin/python

# A sourced ROS would add a second copy of the libraries in the environment.
unexport PYTHONPATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH

.DEFAULT_GOAL := help
.PHONY: help fly build test check wheel docs bench hard-cases assets figures accuracy lock clean

help:  ## show this list
	@sed -n 's/^\([a-z-]*\):.*##  *\(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 18

fly: build  ## fly the island; options: make fly ARGS="--help"
	@$(RUN) ros2_ws/start.py $(ARGS)

build: $(VENV)/built  ## set up the environment and build the message packages

test: build  ## style, types, import rules, unit and integration tests
	@$(RUN) -m pytest --numprocesses 2 --dist loadfile

assets: build  ## regenerate models and textures from their scripts, byte for byte
	@cd assets && "$(CURDIR)/$(RUN)" -m make

check: build  ## style, types and import rules only
	@$(RUN) -m pytest test/test_repository.py test/test_conventions.py

wheel: $(VENV)/pins  ## build wheels and source archives of the libraries in dist/
	@rm -rf dist
	@for library in $(LIBRARIES); do \
	  rm -rf $$library/build $$library/*.egg-info; \
	  $(RUN) -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation --wheel-dir dist $$library \
	  && (cd $$library && $(abspath $(RUN)) -c 'from setuptools import build_meta; build_meta.build_sdist("$(CURDIR)/dist")' \
	      > /dev/null) || exit 1; \
	  rm -rf $$library/build $$library/*.egg-info; \
	done
	@ls dist

docs: $(VENV)/docs  ## build the documentation site; open site/index.html
	@PATH="$(abspath $(VENV))/bin:$$PATH" NO_MKDOCS_2_WARNING=1 $(VENV)/bin/mkdocs build --quiet --strict

bench: $(VENV)/peers  ## compare speed with other libraries; make bench ARGS="--quick"
	@$(RUN) -m bench.collision $(ARGS)
	@$(RUN) -m bench.dynamics $(ARGS)
	@$(RUN) -m bench.render $(ARGS)
	@$(RUN) -m bench.graph $(ARGS)

hard-cases: $(VENV)/peers  ## test millions of hard pairs and hours of motion (ten minutes); make hard-cases ARGS="--count 1000"
	@$(RUN) -m bench.hard_cases $(ARGS); reached=$$?; $(RUN) -m figures.hard_cases.motion; exit $$reached

figures: build  ## redraw the pictures and films of the documentation
	@$(RUN) -m figures.render.stills
	@$(RUN) -m figures.render.island_film
	@$(RUN) -m figures.render.levels_film
	@$(RUN) -m figures.hard_cases.collision
	@$(RUN) -m figures.hard_cases.motion
	@$(RUN) -m figures.effects
	@$(RUN) -m figures.flight_models

accuracy: $(VENV)/peers  ## measure the cost of accuracy: tables, numbers and plots (five minutes)
	@$(RUN) -m bench.accuracy.collision
	@$(RUN) -m figures.accuracy.collision
	@$(RUN) -m bench.accuracy.motion
	@$(RUN) -m figures.accuracy.motion

lock: $(VENV)/peers $(VENV)/docs  ## rewrite requirements/lock.txt from this environment
	@$(RUN) requirements/lock.py

clean:  ## remove the environment and all build outputs
	rm -rf $(VENV) ros2_ws/build ros2_ws/install ros2_ws/log dist site

$(VENV)/pins: $(PINS) requirements/system.sh
	@sh requirements/system.sh $(PYTHON)
	@$(PYTHON) -m venv $(VENV)
	@echo "installing the pinned packages (about a minute) ..."
	@$(VENV)/bin/pip install --quiet --disable-pip-version-check --constraint requirements/lock.txt \
	    --requirement requirements/ros.txt --requirement requirements/run.txt --requirement requirements/dev.txt
	@touch $@

$(VENV)/peers: $(VENV)/built requirements/bench.txt
	@echo "installing the libraries that benchmarks compare with ..."
	@$(VENV)/bin/pip install --quiet --disable-pip-version-check --constraint requirements/lock.txt \
	    --requirement requirements/bench.txt
	@touch $@

$(VENV)/docs: $(VENV)/pins requirements/docs.txt
	@echo "installing the documentation tools ..."
	@$(VENV)/bin/pip install --quiet --disable-pip-version-check --constraint requirements/lock.txt \
	    --requirement requirements/docs.txt
	@touch $@

$(VENV)/built: $(VENV)/pins $(SOURCES) ros2_ws/build.sh
	@bash ros2_ws/build.sh $(VENV) $(INTERFACES)
	@touch $@
